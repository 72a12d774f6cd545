"""Results as JSON, for services and as pages of HTML; `viewing` shows robots in the browser.

In: outcomes and tables. Out: texts, files, a page that is served.
It imports `pipeline`, `live`, `sweeping` and what is below them.
"""
