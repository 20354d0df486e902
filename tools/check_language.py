#!/usr/bin/env python3
"""tools/check_language.py [FILE ...]: refuses words that docs/glossary.md replaces by the field's terms, comments and
doc strings that begin with "What", and in C++ numbers as text that depend on the host's locale.

Looks at identifiers, comments, texts and prose of all tracked sources, tests, scripts and documentation, or of the given
files. The glossary itself is left out. Identifiers are split into their words, so that
`StandWitness` and `stand_witness` are found by `witness`. Comments are those of C++, Python, shell, CMake and LCM files;
headings of documentation may begin with "What". Prints FILE:LINE, the word, and what to say instead.

Programs that use the library may set a locale with a decimal comma or groups of digits. The library's sources write and
read numbers by common/exact_text.hpp and std::from_chars; no program of cartvo sets a locale, so they may use printf.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# Pattern of one or more words (lower case) -> what to say instead.
REJECTED = {
    r"witness(es|ed)?|testif(y|ies|ied)": "detector, check, evidence",
    r"foretells?|foretold": "predict, predicted",
    r"own(s|ed|ing)? up": "inflate (a covariance)",
    r"hangs|hanging": "frozen (camera, image), stalled (process, connection)",
    r"nobody": "no (noun), unknown",
    r"successors?|succession": "candidate track",
    r"rival(s|led|ling)?": "ambiguous, second-best",
    r"leaps?|leaping": "innovation, jump",
    r"doubt(s|ed|ful)?": "inflation, uncertainty",
    r"believes?|believed": "accept, valid",
    r"keystone": "the x*y term of the rows (yaw + 2 p2)",
    r"sightings?": "observation",
    r"gentleness|hopeless": "name the quantity and its unit",
    r"late right|by late": "time offset, sensitivity to the time offset",
    r"aim at|aims at": "target (feature count)",
    r"hears|heard": "receive, update",
}
# File format keys and other names that people already use.
ALLOWED = {
    "tools/calibrate/mount/calibrate_mount.cpp": ("sightings",),  # JSON key of `cartvo calibrate mount`
    "tests/system/in_vm.sh": ("nobody",),  # the system user
}
LEFT_OUT = ("docs/glossary.md", "tools/check_language.py", "LICENSE")
KINDS = (".cpp", ".hpp", ".js", ".md", ".py", ".pyi", ".sh", ".yaml", ".lcm", ".txt", ".1", ".5", ".8", ".in", ".cmake")
# Kinds of files in which # and // do not begin a comment.
WITHOUT_COMMENTS = (".md", ".txt", ".1", ".5", ".8")
# A comment or doc string that begins with "What", also the rest of a comment that continues on this line.
WHAT_COMMENT = re.compile(r'(?:(?<!:)//+[/!]?<?|(?:^|\s)#+:?|"""|/\*+)\s*What\b')
LIBRARY = ("common/", "vo_core/", "calib/", "capture/", "pipeline/", "client/", "python/")
SETS_LOCALE = re.compile(r"\bsetlocale\b|\blocale::global\b|\blocale\(\"\"")
BY_LOCALE = re.compile(r"\b(?:sto(?:d|f|ld)|strto(?:d|f|ld)|atof|sscanf|setprecision|[io]?stringstream|cv::format)\b"
                       r"|printf\s*\([^;]*?(?<!%)%[-+ #0-9.*]*L?[aefgAEFG]")
# Streams of text without numbers.
TEXT_STREAMS = {
    "capture/dataset/image_folder.cpp": "istringstream", "capture/isapi/isapi_client.cpp": "istringstream",
    "capture/isapi/xml_document.cpp": "ostringstream", "capture/recording/recording_index.cpp": "istringstream",
    "common/command_line/parser.cpp": "ostringstream", "common/command_line/terminal.cpp": "istringstream",
    "common/strict_yaml.cpp": "istringstream",
}
PATTERN = re.compile("|".join(rf"(?P<g{i}>\b(?:{pattern})\b)" for i, pattern in enumerate(REJECTED)))


def words_of(line: str) -> str:
    """The line with identifiers split into lower-case words."""
    return re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", line).replace("_", " ").lower()


def has_comments(file: pathlib.Path) -> bool:
    return file.suffix not in WITHOUT_COMMENTS or file.name == "CMakeLists.txt"


def locale_findings(name: str, text: str) -> list[str]:
    """Uses of the host's locale in a C++ source."""
    if not name.endswith((".cpp", ".hpp")) or name.startswith("tests/"):
        return []
    found = list(SETS_LOCALE.finditer(text))
    if name.startswith(LIBRARY):
        found += [match for match in BY_LOCALE.finditer(text)
                  if match.group() != TEXT_STREAMS.get(name)]
    return [f"{name}:{text.count(chr(10), 0, match.start()) + 1}: \"{match.group().split('(')[0]}\" depends on the host's "
            "locale: use common/exact_text.hpp or std::from_chars" for match in found]


def findings(file: pathlib.Path) -> list[str]:
    name = file.relative_to(ROOT).as_posix()
    text = file.read_text(errors="replace") if file.exists() else ""
    found = locale_findings(name, text)
    for number, line in enumerate(text.splitlines(), 1):
        for match in PATTERN.finditer(words_of(line)):
            if match.group(0) in ALLOWED.get(name, ()):
                continue
            instead = list(REJECTED.values())[int(match.lastgroup[1:])]
            found.append(f"{name}:{number}: \"{match.group(0)}\": say {instead} (docs/glossary.md)")
        if has_comments(file) and WHAT_COMMENT.search(line):
            found.append(f"{name}:{number}: comment begins with \"What\": name the thing, its unit or frame")
    return found


def main() -> int:
    if {"-h", "--help"} & set(sys.argv[1:]):
        print(__doc__.rstrip())
        return 0
    names = [str(pathlib.Path(name).resolve().relative_to(ROOT)) for name in sys.argv[1:]] or subprocess.run(
        ["git", "-C", ROOT, "ls-files"], capture_output=True, text=True, check=True).stdout.splitlines()
    files = [ROOT / name for name in names if not name.startswith(LEFT_OUT)]
    files = [file for file in files if file.is_file() and (file.suffix in KINDS or file.suffix == "")]
    found = [line for file in files for line in findings(file)]
    print("\n".join(found) if found else f"check_language: {len(files)} files: in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
