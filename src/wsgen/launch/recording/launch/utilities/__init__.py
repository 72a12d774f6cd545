"""Helpers that users call too."""

from launch._lazy import finder

_HOMES = {
    "ensure_argument_type": "ensure_argument_type_impl",
    "is_a": "class_tools_impl",
    "is_a_subclass": "class_tools_impl",
    "isclassinstance": "class_tools_impl",
    "normalize_to_list_of_entities": "normalize_to_list_of_entities_impl",
    "normalize_to_list_of_substitutions": "normalize_to_list_of_substitutions_impl",
    "perform_substitutions": "perform_substitutions_impl",
    "type_utils": "",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
