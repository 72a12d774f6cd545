"""What to write where catkin_pkg refuses a package.xml, by its words."""

from __future__ import annotations

import re

from wsgen.suggestions import did_you_mean, nearest

EXAMPLES = {
    "name": "<name>my_package</name>",
    "version": "<version>0.0.0</version>",
    "description": "<description>What the package is for.</description>",
    "maintainer": '<maintainer email="you@example.com">Your Name</maintainer>',
    "license": "<license>Apache-2.0</license>",
}

# The elements of format 3, below <package>.
TAGS = (
    *("name", "version", "description", "maintainer", "license", "url", "author", "export"),
    *("build_depend", "build_export_depend", "buildtool_depend", "buildtool_export_depend"),
    *("exec_depend", "depend", "doc_depend", "test_depend", "conflict", "replace"),
    *("group_depend", "member_of_group"),
)

# Tried in order; the words of the complaint that are in parentheses go into the hint.
HINTS = (
    (r"Only one <(\w+)>", "Keep one <{0}>."),
    (r'more than one "(\w+)"', "Keep one <{0}>."),
    (r'version "(.*)" does not follow', "Write three numbers: <version>1.0.0</version>"),
    (
        r'name "(.*)" does not follow',
        "Write lower-case letters, digits and _, a letter first; and the same name in project().",
    ),
    (r'nvalid email "(.*)" for', 'Write an address: email="you@example.com"'),
    (r"must have an (email) address", 'Write an address: email="you@example.com"'),
    (r"package with the same (name) as this", "Remove the package's dependency on itself."),
    (r"replace <(\w+)> tags with <\w+>", "Rename the tags."),
    (r"following tags: (.+)", "Remove or rename {0}: this format has no such elements."),
    (r"must not contain the following children: (.+)", "Remove {0}: a plain text is expected."),
    (r"redundant with: (.+)", "Remove one of the two dependencies."),
    (r'"format" attribute|invalid literal for int', 'Write: <package format="3">'),
    (r'The "(\w+)" tag must have the attribute "(\w+)"', 'Write: <{0} {1}="...">'),
)
MISSING = re.compile(
    r'(?:exactly one "|at least one "?|Package |The )'
    r'(name|version|description|maintainer|license)(?:"| tag must| must not be empty|$)'
)
OTHERWISE = "REP-149 describes the format of package.xml."


def hint_for(complaint: str, text: str) -> str:
    """Say what to write.

    Args:
        complaint: one of catkin_pkg's sentences.
        text: the package.xml.
    """
    missing = MISSING.search(complaint)
    if missing:
        element = missing[1]
        if len(re.findall(rf"<{element}[\s>]", text)) > 1 and "exactly one" in complaint:
            return f"Keep one <{element}>."
        return f"Add: {EXAMPLES[element]}"
    unknown = re.search(r"following tags: (.+?)\.?$", complaint)
    for tag in unknown[1].split(", ") if unknown else ():
        near = nearest(tag, TAGS)
        if near is not None:
            return did_you_mean(near)
    for pattern, hint in HINTS:
        match = re.search(pattern, complaint)
        if match:
            return hint.format(*(group or "" for group in match.groups()))
    return OTHERWISE
