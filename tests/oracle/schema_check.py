"""Validates JSON files against a JSON Schema: schema_check.py schema.json file.json ...

Prints one line of JSON: for each file the list of places ("/pieces/0/open") where it breaks the schema, sorted. Exit
status 1 if the schema itself is invalid.
"""

import json
import sys

from jsonschema import Draft202012Validator


def refuse_constant(name):
    raise ValueError(f"{name} is not JSON")


def load(name):
    with open(name, encoding="utf-8") as file:
        return json.load(file, parse_constant=refuse_constant)


def places(validator, document):
    return sorted({"/" + "/".join(map(str, error.absolute_path)) for error in validator.iter_errors(document)})


def main():
    schema = load(sys.argv[1])
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    print(json.dumps([places(validator, load(name)) for name in sys.argv[2:]]))


if __name__ == "__main__":
    main()
