"""Print what is wrong with a scene file by a JSON Schema; nothing if it is valid.

Usage: python3 validate_scene.py SCHEMA.json SCENE.toml
"""

import json
import sys
import tomllib

from jsonschema import Draft202012Validator


def main(schema_path, scene_path):
    with open(schema_path, encoding="utf-8") as file:
        schema = json.load(file)
    Draft202012Validator.check_schema(schema)
    with open(scene_path, "rb") as file:
        scene = tomllib.load(file)
    for error in Draft202012Validator(schema).iter_errors(scene):
        place = ".".join(str(part) for part in error.absolute_path)
        # Of a choice, what is wrong with each.
        for cause in [error, *error.context]:
            print(f"{place}: {cause.message}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
