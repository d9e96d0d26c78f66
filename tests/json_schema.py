"""Values that are not as a JSON Schema says, for the keywords that the schemas of the project use."""

from typing import Any


def faults_of(value: Any, schema: Any, root: Any, at: str = "") -> list[str]:
    """A sentence for each fault of a value."""
    if "$ref" in schema:
        return faults_of(value, root["$defs"][schema["$ref"].rpartition("/")[2]], root, at)
    types = {"object": dict, "array": list, "string": str, "number": int | float, "integer": int, "null": type(None)}
    names = schema.get("type", [])
    names = [names] if isinstance(names, str) else names
    if names and not any(isinstance(value, types[name]) for name in names):
        return [f"{at}: {type(value).__name__}, expected {names}"]
    result = [] if value in schema.get("enum", [value]) else [f"{at}: {value!r}"]
    if "anyOf" in schema and all(faults_of(value, one, root, at) for one in schema["anyOf"]):
        result.append(f"{at}: none of anyOf")
    if isinstance(value, dict):
        result += [f"{at}: no {key}" for key in schema.get("required", []) if key not in value]
        known = schema.get("properties", {})
        result += [fault for key in value if key in known for fault in faults_of(value[key], known[key], root, key)]
        if schema.get("additionalProperties") is False:
            result += [f"{at}: {key} is not in the schema" for key in value if key not in known]
    if isinstance(value, list) and "items" in schema:
        result += [fault for one in value for fault in faults_of(one, schema["items"], root, at)]
    return result
