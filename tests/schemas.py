"""The JSON schemas of the documentation."""

import json

from jsonschema import Draft202012Validator
from places import ROOT


def schema(name):
    path = ROOT / f"docs/reference/{name}.schema.json"
    return Draft202012Validator(json.loads(path.read_text(encoding="utf-8")))
