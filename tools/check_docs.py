#!/usr/bin/env python3
"""Holds the documentation to the tree: links resolve, named commands and files exist, man pages format cleanly.

Usage: tools/check_docs.py [PATH-OF-CARTVO]   (default build/release/tools/cartvo/cartvo)
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def tracked(pattern):
    names = subprocess.run(["git", "ls-files", pattern], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [ROOT / name for name in names.split()]


def heading_anchor(heading):
    """GitHub's anchor of a Markdown heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower().replace("`", "")).replace(" ", "-")


def anchors_of(page):
    return {heading_anchor(match) for match in re.findall(r"^#+ (.+)$", page.read_text(), re.M)}


def broken_links(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists():
            yield f"{page.relative_to(ROOT)}: link to {target}: no such file"
        elif anchor and file.suffix == ".md" and anchor not in anchors_of(file):
            yield f"{page.relative_to(ROOT)}: link to {target}: no such heading"


def missing_files(page):
    """Paths of this repository named in `code` must exist."""
    folders = "capture|calib|vo_core|daemon|systemd|config|tests|tools|docs"
    for name in re.findall(rf"`((?:{folders})/[\w./-]+)`", page.read_text()):
        if not (ROOT / name).exists():
            yield f"{page.relative_to(ROOT)}: names {name}, which does not exist"


def subcommands_of(program):
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"^  (\w+) ", text.partition("Subcommands:")[2], re.M))


def unknown_commands(page, known):
    for block in re.findall(r"```(?:sh|console)?\n(.*?)```", page.read_text(), re.S):
        for name in re.findall(r"(?:^|[\s/])cartvo (\w[\w-]*)", block):
            if name not in known:
                yield f"{page.relative_to(ROOT)}: names the command 'cartvo {name}', which does not exist"


def undocumented_commands(known):
    for name in known:
        if not (ROOT / f"docs/man/cartvo-{name}.1").exists():
            yield f"docs/man: cartvo-{name}.1 is missing"


def man_page_warnings(page):
    result = subprocess.run(["man", "--warnings", "--local-file", page], env={"MANWIDTH": "80", "LC_ALL": "C.UTF-8",
                            "MANROFFSEQ": "", "PATH": "/usr/bin:/bin"}, capture_output=True, text=True)
    for line in result.stderr.splitlines():
        yield f"{page.relative_to(ROOT)}: {line}"


def main():
    program = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/tools/cartvo/cartvo")
    known = subcommands_of(program)
    problems = list(undocumented_commands(known))
    pages = tracked("*.md")
    for page in pages:
        problems += [*broken_links(page), *missing_files(page), *unknown_commands(page, known)]
    man_pages = tracked("docs/man/*")
    for page in man_pages:
        problems += man_page_warnings(page)
    print("\n".join(problems) if problems else f"check_docs: {len(pages)} pages, {len(man_pages)} man pages, "
          f"{len(known)} commands: in order")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
