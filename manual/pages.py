"""The pages of the manual that are made and not written: the reference of scene files, the gallery, the table of contents.

Usage: python pages.py SCHEMA.json SOURCE, where SOURCE is a copy of the repository's pages in their places.
"""

import json
import re
import sys
from pathlib import Path


def kind(item, names):
    """What a key takes, in words; a type of its own as a link to its section."""
    if "$ref" in item:
        name = item["$ref"].rsplit("/", 1)[1]
        return f"[{names[name]}](#{name.lower()})"
    if "anyOf" in item or "oneOf" in item:
        kinds = [kind(choice, names) for choice in item.get("anyOf", item.get("oneOf")) if choice.get("type") != "null"]
        return " or ".join(dict.fromkeys(kinds))
    if "const" in item or "enum" in item:
        return ", ".join(f"`{value}`" for value in item.get("enum", [item.get("const")]))
    if "prefixItems" in item:
        return "[" + ", ".join(kind(part, names) for part in item["prefixItems"]) + "]"
    if item.get("type") == "array":
        inner = kind(item.get("items", {}), names)
        count = item.get("minItems")
        return f"{count} × {inner}" if count and count == item.get("maxItems") else f"list of {inner}"
    words = {"number": "number", "integer": "whole number", "string": "text", "boolean": "`true` or `false`", "object": "table"}
    types = item.get("type", "anything")
    types = [types] if isinstance(types, str) else types
    return " or ".join(words.get(name, name) for name in types if name != "null")


def cell(text):
    return " ".join(str(text).split()).replace("|", "\\|")


def default(item, is_required):
    if is_required:
        return "required"
    return f"`{json.dumps(item['default'])}`" if item.get("default") is not None else ""


def table(schema, names):
    lines = ["| key | what it takes | default | what it means |", "| --- | --- | --- | --- |"]
    for key, item in schema.get("properties", {}).items():
        row = [f"`{key}`", kind(item, names), default(item, key in schema.get("required", [])), item.get("description", "")]
        lines.append("| " + " | ".join(cell(part) for part in row) + " |")
    return lines


def choices(schema):
    """The names of a type that is one of some."""
    listed = [(value, "") for value in schema.get("enum", [])]
    for choice in schema.get("oneOf", schema.get("anyOf", [])):
        values = choice.get("enum", [choice["const"]] if "const" in choice else [])
        listed += [(value, choice.get("description", "")) for value in values]
    return [f"- `{value}`" + (f": {cell(text)}" if text else "") for value, text in listed]


def reference(schema):
    """Scene files, a section a table."""
    names = {name: re.sub(r"Spec$", "", name) for name in schema["$defs"]}
    lines = ["# Scene files", "", "Made from `koiter schema`, by which editors complete and check scenes too. "
             "A key in brackets, `[[shell]]`, is a list of tables. Everything is in SI units, z is up.", "", "## The top", ""]
    lines += table(schema, names)
    for name, definition in schema["$defs"].items():
        lines += ["", f'<a id="{name.lower()}"></a>', "", f"## {names[name]}", "", definition.get("description", ""), ""]
        lines += table(definition, names) if "properties" in definition else choices(definition)
    return "\n".join(lines) + "\n"


def gallery(scenes):
    """A section a scene: its picture, what it is, its first command."""
    lines = ["# Gallery", "", "The scenes that ship with Koiter. Each page has what to look for, what to try, and the time it takes."]
    for page in sorted(scenes.glob("*/README.md")):
        name, text = page.parent.name, page.read_text(encoding="utf-8")
        here = text.replace("](../../docs/", "](").replace("](../", "](../scenes/")
        paragraphs = [part.strip() for part in here.split("\n\n")[1:]]
        picture = [part for part in paragraphs[:2] if part.startswith("![")]
        what = next(part for part in paragraphs if part and part[0] not in "!`#|")
        command = re.search(r"^koiter run .*$", text, re.MULTILINE)
        lines += ["", f"## [{name}](../scenes/{name}/README.md)", "", *picture, *([""] if picture else []), what, "",
                  f"```sh\n{command.group(0) if command else f'koiter run {name}'}\n```"]
        seconds = re.search(r"[^.\n]*(?:about|some) [\w ]*?(?:minutes?|seconds?|hours?)[^.]*\.", what_it_takes(here))
        lines += ["", f"*{cell(seconds.group(0))}*"] if seconds else []
    return "\n".join(lines) + "\n"


def what_it_takes(text):
    """The text without code and tables, where sentences on time are looked for."""
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return "\n".join(line for line in text.splitlines() if not line.startswith("|"))


def title(page):
    return page.read_text(encoding="utf-8").splitlines()[0].lstrip("# ")


def contents(source):
    """The table of contents at the top of `source`: that of `docs`, with a page a scene, problem and decision."""
    text = (source / "docs/SUMMARY.md").read_text(encoding="utf-8")
    # Links are from where the table stands.
    text = re.sub(r"\]\((?!\.\./)", "](docs/", text).replace("](../", "](")
    scenes = [page for page in sorted(source.glob("scenes/*/README.md")) if f"]({page.relative_to(source)})" not in text]
    listed = "".join(f"  - [{page.parent.name}]({page.relative_to(source)})\n" for page in scenes)
    text = text.replace("- [Gallery](docs/gallery.md)\n", f"- [Gallery](docs/gallery.md)\n{listed}")
    more = [*sorted(source.glob("benchmarks/*/*.md")), *sorted(source.glob("docs/decisions/*.md")), *sorted(source.glob("fuzz/*.md"))]
    return text + "".join(f"- [{title(page)}]({page.relative_to(source)})\n" for page in more)


def name_pages(source):
    """Turns links to folders into links to the pages that stand for them: a book has no folders."""
    for page in source.rglob("*.md"):
        def named(match, page=page):
            path, anchor = match.group(1), match.group(2) or ""
            return f"]({path.rstrip('/')}/README.md{anchor})" if (page.parent / path / "README.md").exists() else match.group(0)

        # The table of contents is on every page of a book.
        text = page.read_text(encoding="utf-8").replace("](docs/SUMMARY.md)", "](docs/first-five-minutes.md)")
        page.write_text(re.sub(r"\]\(([^)#\s:]+)(#[^)\s]*)?\)", named, text), encoding="utf-8")


def main(schema, source):
    source = Path(source)
    read = json.loads(Path(schema).read_text(encoding="utf-8"))
    (source / "docs/scene-reference.md").write_text(reference(read), encoding="utf-8")
    (source / "docs/gallery.md").write_text(gallery(source / "scenes"), encoding="utf-8")
    (source / "SUMMARY.md").write_text(contents(source), encoding="utf-8")
    name_pages(source)


if __name__ == "__main__":
    main(*sys.argv[1:])
