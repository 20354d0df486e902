#!/usr/bin/env python3
"""Checks the documentation against the tree and the programs.

Usage: tools/check_docs.py [PATH-OF-CARTVO [PATH-OF-CARTVOD]]
       (default build/release/tools/cartvo/cartvo and, beside it, ../../daemon/cartvod)

Every page: links and pictures resolve, and pictures have a text that stands for them. docs/pictures: each picture is small, and
a page shows it. Every page: commands parse (subcommands, options), paths exist, no issue number, no commit hash. Words: at
most 4,000 in docs/architecture.md, 3,000 in docs/how-it-works.md, and 20,000 in the user pages together, which are the
others in docs but the glossary. docs/how-it-works.md: the code that it names exists. Man pages: they format cleanly, their
examples parse, each command has one. Sources: the pages that they name exist.
"""
import functools
import pathlib
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs/pictures"
PICTURE_MOST_BYTES = 60_000
HOW_IT_WORKS = ROOT / "docs/how-it-works.md"
MOST_WORDS = {ROOT / "docs/architecture.md": 4000, HOW_IT_WORKS: 3000}
USER_PAGES_MOST_WORDS = 20_000  # together
NO_USER_PAGES = {*MOST_WORDS, ROOT / "docs/glossary.md"}
FOLDERS = ".ci|calib|capture|client|common|config|daemon|debian|docs|examples|lab|library|pipeline|python|systemd|tests|tools|vo_core"
MAN_ENVIRONMENT = {"MANWIDTH": "80", "LC_ALL": "C.UTF-8", "MANROFFSEQ": "", "PATH": "/usr/bin:/bin"}


def files(*patterns):
    """The tree's files that match: tracked ones and new ones, without those that are ignored or deleted."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *patterns]
    names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return sorted({ROOT / name for name in names.splitlines() if (ROOT / name).is_file()})


# Links.


def heading_anchor(heading):
    """GitHub's anchor of a Markdown heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def without_code_blocks(text):
    return re.sub(r"^ *```.*?^ *```", "", text, flags=re.M | re.S)


def anchors_of(page):
    return {heading_anchor(match) for match in re.findall(r"^#+ (.+)$", without_code_blocks(page.read_text()), re.M)}


def links_of(page):
    """(target as written, file, anchor) of each link within the tree."""
    text = without_code_blocks(page.read_text())
    for target in re.findall(r"\]\(([^)\s]+)\)|^\[[^\]]+\]: (\S+)", text, re.M):
        target = target[0] or target[1]
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        yield target, (page.parent / name).resolve() if name else page, anchor


def broken_links(page):
    for target, file, anchor in links_of(page):
        if not file.exists():
            yield f"link to {target}: no such file"
        elif anchor and file.suffix == ".md" and anchor not in anchors_of(file):
            yield f"link to {target}: no such heading"


def pictures_without_text(page):
    for target in re.findall(r"!\[\s*\]\(([^)\s]+)\)", without_code_blocks(page.read_text())):
        yield f"picture {target}: has no text that stands for it"


def problems_of_picture(picture, shown):
    if picture.stat().st_size > PICTURE_MOST_BYTES:
        yield f"has {picture.stat().st_size} bytes: at most {PICTURE_MOST_BYTES}"
    if picture not in shown:
        yield "no page shows it"


# Words.


def dated_references(text):
    """References that only make sense beside this project's history."""
    for match in re.findall(r"\bissues? #?\d+", text, re.I):
        yield f"names '{match}'"
    for match in re.findall(r"\b[0-9a-f]{7,40}\b", text):
        if re.search("[0-9]", match) and re.search("[a-f]", match):
            yield f"names what looks like a commit: {match}"


def missing_paths(text):
    """Paths of this tree, in code spans and blocks; those with wildcards or placeholders are left out."""
    for code in re.findall(r"^ *```.*?^ *```|`[^`]+`", text, re.M | re.S):
        for name in re.findall(rf"(?<![\w/.~$*-])((?:{FOLDERS})/[^\s`'\"(),:;|]*)", code):
            name = name.rstrip(".")
            if not re.search(r"[*<>{}$\[\]…]|\.\.\.|/[A-Z]+(/|$)", name) and not (ROOT / name).exists():
                yield f"names {name}, which does not exist"


def words_in(page):
    """As wc -w counts them."""
    return len(page.read_text().split())


def too_long(page):
    words, most = words_in(page), MOST_WORDS.get(page)
    if most is not None and words > most:
        yield f"has {words} words: at most {most}"


def too_long_together(pages):
    user_pages = [page for page in pages if page.parent == ROOT / "docs" and page not in NO_USER_PAGES]
    words = sum(map(words_in, user_pages))
    if words > USER_PAGES_MOST_WORDS:
        yield f"docs: the user pages have {words} words: at most {USER_PAGES_MOST_WORDS}"


def missing_code(page):
    """References of the form `file` / `Class::function`."""
    sources = {}
    for file in files("*.cpp", "*.hpp"):
        if "tests" not in file.relative_to(ROOT).parts:
            sources.setdefault(file.stem, []).append(file)
    for stem, name in re.findall(r"`(\w+)`\s*/\s*`([\w:]+)`", page.read_text()):
        text = "\n".join(file.read_text() for file in sources.get(stem, []))
        *scopes, function = name.split("::")
        if not text:
            yield f"names the source {stem}, which does not exist"
        elif not (re.search(rf"\b{function}\(", text) and all(re.search(rf"\b{scope}\b", text) for scope in scopes)):
            yield f"names {name}, which is not in {stem}.hpp or {stem}.cpp"


# Commands.


class Program:
    """A program's subcommands and options, by its --help."""

    def __init__(self, path):
        self.path = path

    @functools.cache
    def help(self, *chain):
        command = [self.path, *chain, "--help"]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    def subcommands(self, *chain):
        text = self.help(*chain).partition("\nSubcommands:\n")[2].partition("\n\n")[0]  # without the footer
        return set(re.findall(r"^  ([a-z][\w-]*)(?: |$)", text, re.M))

    def options(self, *chain):
        lines = re.findall(r"^ {2,4}(-\S+)", self.help(*chain), re.M)
        return {name for names in lines for name in re.split(r"[,=]", names)}

    def takes_positionals(self, *chain):
        return "\nPositionals:\n" in self.help(*chain)

    def misuse(self, arguments):
        """Mistakes in a command line, placeholders (COMMAND, ...) aside."""
        chain = ()
        while arguments and arguments[0] in self.subcommands(*chain):
            chain += (arguments[0],)
            arguments = arguments[1:]
        name = " ".join((self.path.name, *chain))
        if arguments and self.subcommands(*chain) and not self.takes_positionals(*chain):
            if not re.match(r"-|[A-Z]|\.\.\.|…|<", arguments[0]):
                yield f"'{name}' has no subcommand {arguments[0]}"
            elif not arguments[0].startswith("-"):
                return  # a placeholder: which command's options follow is not known
        for argument in arguments:
            option = argument.partition("=")[0].strip("[]")
            if re.fullmatch(r"--[a-z][\w-]*|-[A-Za-z]", option) and option not in self.options(*chain):
                yield f"'{name}' has no option {option}"


def script_misuse(path, arguments):
    """The same of a script of this tree; options of one that hands its own on are not known."""
    script = ROOT / path
    if not script.is_file():
        yield f"names the command {path}, which does not exist"
        return
    text = script.read_text()
    if path == "lab/lab":  # its commands are modules
        text += "".join(module.read_text() for module in sorted((ROOT / "lab/laboratory").glob("*.py")))
    for option in arguments:
        option = option.partition("=")[0].strip("[]")
        if re.fullmatch(r"--[a-z][\w-]*", option) and '"$@"' not in text and option not in text and option != "--help":
            yield f"{path} has no option {option}"


def simple_commands(line):
    """The command lines that a line of shell holds, each a list of words: pipes, lists and redirections taken apart."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    words, skip = [], False
    for token in lexer:
        if set(token) <= set("();|&"):
            yield words
            words, skip = [], False
        elif set(token) <= set("<>&|"):
            if words and words[-1].isdigit():
                words.pop()
            skip = True
        elif skip:
            skip = False
        else:
            words.append(token)
    yield words


def without_prefix(words):
    """A command without what runs it: keywords, variables, sudo, a namespace."""
    while words:
        if words[0] in ("do", "then", "else", "if", "while", "until", "time", "env", "exec", "!", "{", "sudo"):
            words = words[1:]
            while words and words[0].startswith("-"):  # of sudo, with a user
                words = words[2:] if words[0] in ("-u", "-g") else words[1:]
        elif re.match(r"\w+=", words[0]) or words[0] == "tools/in_network_namespace":
            words = words[1:]
        else:
            break
    return words


def command_misuse(line, programs):
    try:
        commands = list(simple_commands(line))
    except ValueError as error:
        yield f"cannot be read as shell ({error}): {line.strip()}"
        return
    for words in map(without_prefix, commands):
        if not words:
            continue
        name = pathlib.PurePath(words[0]).name
        if name in programs:
            yield from programs[name].misuse(words[1:])
        elif re.match(r"(\./)?(lab|tools|tests)/[a-z]", words[0]):
            yield from script_misuse(words[0].removeprefix("./"), words[1:])


def joined(text):
    return re.sub(r"\\\n\s*", " ", text).splitlines()


def commands_of_page(page):
    """Lines of sh blocks, prompts of console blocks, and code spans that begin with one of our commands."""
    text = page.read_text()
    for language, block in re.findall(r"^ *```(sh|bash|console)\n(.*?)^ *```", text, re.M | re.S):
        for line in joined(block):
            if language != "console":
                yield line
            elif prompt := re.match(r"\s*[$#] (.+)", line):
                yield prompt[1]
    for span in re.findall(r"`([^`]+)`", without_code_blocks(text)):
        if re.match(r"(cartvod?|cartvo-render|(?:lab|tools)/\w+)( |$)", span):
            yield " ".join(span.split())


def commands_of_man_page(page):
    """Lines of the examples."""
    examples = re.findall(r"^\.SH EXAMPLES?\n(.*?)(?=^\.SH|\Z)", page.read_text(), re.M | re.S)
    for block in re.findall(r"^\.nf\n(.*?)^\.fi", "".join(examples), re.M | re.S):
        text = re.sub(r"\\f[BIPR]|\\&", "", block)
        text = text.replace(r"\-", "-").replace(r"\(aq", "'").replace(r"\e", "\\")
        yield from (line for line in joined(text) if not line.startswith("."))


def wrong_commands(lines, programs):
    for line in lines:
        yield from command_misuse(line, programs)


# Man pages.


def undocumented_commands(program):
    for name in program.subcommands():
        if not (ROOT / f"docs/man/cartvo-{name}.1").exists():
            yield f"docs/man: cartvo-{name}.1 is missing"


def man_page_warnings(page):
    command = ["man", "--warnings", "--local-file", page]
    result = subprocess.run(command, env=MAN_ENVIRONMENT, capture_output=True, text=True)
    yield from result.stderr.splitlines()


def problems_of_page(page, programs):
    yield from broken_links(page)
    yield from pictures_without_text(page)
    text = page.read_text()
    yield from too_long(page)
    yield from dated_references(text)
    yield from missing_paths(text)
    yield from wrong_commands(commands_of_page(page), programs)
    if page == HOW_IT_WORKS:
        yield from missing_code(page)


def problems_of_man_page(page, programs):
    yield from man_page_warnings(page)
    yield from dated_references(page.read_text())
    yield from wrong_commands(commands_of_man_page(page), programs)


def problems_of_source(source):
    """Pages that a source or its help names."""
    for name in sorted(set(re.findall(r"\bdocs/[\w/-]+\.md\b", source.read_text()))):
        if not (ROOT / name).exists():
            yield f"names {name}, which does not exist"


def main():
    cartvo = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/tools/cartvo/cartvo")
    cartvod = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else cartvo.parent.parent.parent / "daemon/cartvod"
    for program in (cartvo, cartvod):
        if not program.is_file():
            sys.exit(f"check_docs: {program} does not exist: build it (tools/build), or name it")
    programs = {"cartvo": Program(cartvo), "cartvod": Program(cartvod)}
    renderer = cartvo.parent.parent.parent / "lab/render/cartvo-render"
    if renderer.is_file():
        programs["cartvo-render"] = Program(renderer)
    pages, man_pages = files("*.md"), files("docs/man/*")
    pictures = files(*(f"{PICTURES.relative_to(ROOT)}/*.{kind}" for kind in ("png", "svg")))
    shown = {file for page in pages for _, file, _ in links_of(page)}
    problems = [*undocumented_commands(programs["cartvo"]), *too_long_together(pages)]
    for check, checked in ((lambda page: problems_of_page(page, programs), pages),
                           (lambda page: problems_of_man_page(page, programs), man_pages),
                           (lambda picture: problems_of_picture(picture, shown), pictures),
                           (problems_of_source, files("*.cpp", "*.hpp", "*.py", "*.yaml", "*.sh"))):
        for file in checked:
            problems += [f"{file.relative_to(ROOT)}: {problem}" for problem in check(file)]
    print("\n".join(problems) if problems else f"check_docs: {len(pages)} pages, {len(man_pages)} man pages: in order")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
