"""Writes sceneloom/types.py, calls.py and edits.py from `sceneloom schema`: python generate.py [PROGRAM]"""

from __future__ import annotations

import json
import keyword
import os
import pathlib
import subprocess
import sys
import textwrap
from typing import Any

HEAD = '"""{about} Written by generate.py from `sceneloom schema`; do not edit."""\n\nfrom __future__ import annotations\n\n'


def of_ref(schema: dict[str, Any]) -> str:
    return str(schema["$ref"]).removeprefix("#/$defs/")


def hint(schema: Any) -> str:
    """The type of a value, as Python writes it."""
    if schema is True or not schema:
        return "Any"
    if "$ref" in schema:
        return of_ref(schema)
    if "const" in schema:
        return f"Literal[{schema['const']!r}]"
    if "enum" in schema:
        names = [n for n in schema["enum"] if n is not None]
        nothing = " | None" if None in schema["enum"] else ""
        return f"Literal[{', '.join(map(repr, names))}]{nothing}"
    for many in ("oneOf", "anyOf"):
        if many in schema:
            return union([hint(s) for s in schema[many]])
    if "allOf" in schema and len(schema["allOf"]) == 1:
        return hint(schema["allOf"][0])
    kinds = schema.get("type", "object")
    if isinstance(kinds, list):
        return union([hint({**schema, "type": k}) for k in kinds])
    if kinds == "array":
        items = schema.get("items", True)
        return f"Sequence[{hint(items)}]"
    if kinds == "object":
        more = schema.get("additionalProperties")
        return f"dict[str, {hint(more)}]" if isinstance(more, dict) else "dict[str, Any]"
    return {"string": "str", "integer": "int", "number": "float", "boolean": "bool", "null": "None"}[kinds]


def union(hints: list[str]) -> str:
    """Each once; literals together, nothing last."""
    literals = [h[len("Literal[") : -1] for h in hints if h.startswith("Literal[")]
    others = [h for h in dict.fromkeys(hints) if not h.startswith("Literal[") and h != "None"]
    all_of_them = ([f"Literal[{', '.join(literals)}]"] if literals else []) + others
    return " | ".join(all_of_them + (["None"] if "None" in hints else []))


def comment(text: str, indent: str) -> str:
    return "".join(f"{indent}# {line}\n" for line in textwrap.wrap(text, 110 - len(indent)))


def document(text: str, indent: str) -> str:
    lines = textwrap.wrap(text.replace("\\", "\\\\"), 108 - len(indent))
    return indent + '"""' + f"\n{indent}".join(lines) + '"""\n'


def typed_dict(name: str, schema: dict[str, Any]) -> str:
    """An object with known keys."""
    required = schema.get("required", [])
    out = comment(schema.get("description", ""), "") + f"{name} = TypedDict(\n    {name!r},\n    {{\n"
    for key, of in schema.get("properties", {}).items():
        kind = hint(of) if key in required else f"NotRequired[{hint(of)}]"
        about = of.get("description", "") if isinstance(of, dict) else ""
        out += comment(about, " " * 8) + f"        {key!r}: {kind!r},\n"
    return out + "    },\n)\n"


def is_object(schema: dict[str, Any]) -> bool:
    return schema.get("type") == "object" and "properties" in schema


def variant_name(name: str, key: str) -> str:
    return name + "".join(part.capitalize() for part in key.split("_"))


def types(document_: dict[str, Any]) -> str:
    """Every definition; those of arguments are left out, as methods take them one by one."""
    args = {of_ref(c["args"]) for c in document_["x-calls"].values()}
    bodies = []
    for name, schema in sorted(document_["$defs"].items()):
        if name in args:
            continue
        if is_object(schema):
            bodies.append(typed_dict(name, schema))
            continue
        variants = []
        for of in schema.get("oneOf", []):
            if is_object(of) and len(of["properties"]) == 1:
                # {"add_box": {...}}: the inner object gets a name of its own
                (key, inner), = of["properties"].items()
                own = variant_name(name, key)
                if is_object(inner):
                    bodies.append(typed_dict(own + "Args", inner))
                    inner = {"$ref": f"#/$defs/{own}Args"}
                bodies.append(typed_dict(own, {**of, "properties": {key: inner}}))
                variants.append(own)
            elif "$ref" not in of and of.get("type") == "object":
                variants.append("dict[str, Any]")
            else:
                variants.append(hint(of))
        kind = union(variants) if variants else hint(schema)
        bodies.append(comment(schema.get("description", ""), "") + f"{name}: TypeAlias = {kind!r}\n")
    head = HEAD.format(about="Types of what calls take and answer.")
    head += (
        "from typing import TYPE_CHECKING, Any, Literal, Sequence, TypedDict\n\n"
        "if TYPE_CHECKING:\n    from typing_extensions import NotRequired, TypeAlias\n\n"
    )
    return head + "\n".join(bodies)


def safe(key: str) -> str:
    return key + "_" if keyword.iskeyword(key) else key


def defined(name: str, parameters: list[str], result: str, indent: str) -> str:
    """The head of a function, on as many lines as it needs."""
    line = f"{indent}def {name}({', '.join(parameters)}) -> {result}:\n"
    if len(line) <= 110:
        return line
    each = "".join(f"{indent}    {p},\n" for p in parameters)
    return f"{indent}def {name}(\n{each}{indent}) -> {result}:\n"


def signature(schema: dict[str, Any], wrap: str) -> tuple[list[str], str, str]:
    """Parameters after a star, lines of documentation, and the code that collects what was given."""
    properties, required = schema.get("properties", {}), schema.get("required", [])
    ordered = [k for k in properties if k in required] + [k for k in properties if k not in required]
    parameters, about = [], []
    for key in ordered:
        kind = qualified(hint(properties[key]))
        if key not in required:
            kind = kind if kind.endswith("| None") else f"{kind} | None"
            kind += " = None"
        parameters.append(f"{safe(key)}: {kind}")
        text = properties[key].get("description", "") if isinstance(properties[key], dict) else ""
        about += textwrap.wrap(f"{safe(key)}: {text}", 100, subsequent_indent="    ")
    given = ", ".join(f"{key!r}: {safe(key)}" for key in ordered)
    needed = sorted(set(ordered) & set(required))
    collect = f"{wrap} = _given({{{given}}}, {needed!r})"
    if len(collect) > 100:
        each = "".join(f"        {key!r}: {safe(key)},\n" for key in ordered)
        collect = f"{wrap} = _given(\n    {{\n{each}    }},\n    {needed!r},\n)"
    return parameters, "\n".join(about), collect


def qualified(kind: str) -> str:
    """Names of types.py, with their module."""
    out, word = "", ""
    in_quotes = False
    for c in kind + " ":
        if c == "'":
            in_quotes = not in_quotes
        if c.isalnum() or c == "_":
            word += c
            continue
        plain = {"Any", "Literal", "Sequence", "None"}
        out += f"types.{word}" if word and word[0].isupper() and word not in plain and not in_quotes else word
        word = ""
        out += c
    return out[:-1]


GIVEN = '''
def _given(args: dict[str, Any], required: list[str]) -> dict[str, Any]:
    """Without what was left out."""
    return {key: value for key, value in args.items() if value is not None or key in required}
'''


def calls(document_: dict[str, Any]) -> str:
    out = HEAD.format(about="One method per call.")
    out += "from typing import Any, Literal, Sequence\n\nfrom . import types\n\n" + GIVEN
    out += '\n\nclass Calls:\n    """Every call as a method; `call` carries one out."""\n\n'
    out += "    def call(self, name: str, args: dict[str, Any]) -> Any:\n"
    out += '        """Carries a call out and returns its receipt."""\n        raise NotImplementedError\n'
    for name, of in sorted(document_["x-calls"].items()):
        schema = document_["$defs"][of_ref(of["args"])]
        parameters, about, collect = signature(schema, "args")
        star = ["self"] + (["*"] + parameters if parameters else [])
        out += "\n" + defined(safe(name), star, f"types.{of_ref(of['receipt'])}", "    ")
        lines = textwrap.wrap(of["about"], 100) + ([""] + about.split("\n") if about else [])
        out += '        """' + "\n        ".join(lines).replace("        \n", "\n") + '\n        """\n'
        out += textwrap.indent(collect, " " * 8) + "\n"
        out += f'        receipt: types.{of_ref(of["receipt"])} = self.call("{name}", args)\n        return receipt\n'
    return out


def edits(document_: dict[str, Any]) -> str:
    out = HEAD.format(about="One function per edit, for the call `apply`.")
    out += "from typing import Any, Literal, Sequence, cast\n\nfrom . import types\n\n" + GIVEN
    for of in document_["$defs"]["Edit"]["oneOf"]:
        (key, inner), = of["properties"].items()
        parameters, about, collect = signature(inner, "args")
        star = ["*"] + parameters if parameters else []
        out += "\n\n" + defined(safe(key), star, f"types.{variant_name('Edit', key)}", "")
        lines = textwrap.wrap(of.get("description", ""), 100) + ([""] + about.split("\n") if about else [])
        out += '    """' + "\n    ".join(lines).replace("    \n", "\n") + '\n    """\n'
        out += textwrap.indent(collect, " " * 4) + "\n"
        own = f"types.{variant_name('Edit', key)}"
        out += f'    return cast({own!r}, {{"{key}": args}})\n'
    return out


def written(document_: dict[str, Any]) -> dict[str, str]:
    """The three files."""
    return {"types.py": types(document_), "calls.py": calls(document_), "edits.py": edits(document_)}


def schema_of(program: str) -> dict[str, Any]:
    printed = subprocess.run([program, "schema"], check=True, capture_output=True).stdout
    schema: dict[str, Any] = json.loads(printed)
    return schema


def main() -> None:
    program = sys.argv[1] if len(sys.argv) > 1 else os.environ.get("SCENELOOM", "sceneloom")
    folder = pathlib.Path(__file__).parent / "sceneloom"
    for name, text in written(schema_of(program)).items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
