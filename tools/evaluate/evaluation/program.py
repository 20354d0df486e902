"""Files, texts and errors of the program."""
import errno
import json
import math
import os
import pathlib
import stat
import sys
import tempfile

MOST_BYTES = 1 << 28  # of a file that is read
NO_VALUE = "–"
UNPACK = "unpack it and give the file in it"
FOREIGN = {  # first bytes: name, remedy
    b"PK\3\4": ("a ZIP archive", UNPACK), b"\x1f\x8b": ("a gzip archive", UNPACK), b"BZh": ("a bzip2 archive", UNPACK),
    b"\xfd7zXZ": ("an xz archive", UNPACK), b"\x28\xb5\x2f\xfd": ("a zstd archive", UNPACK), b"7z\xbc\xaf": ("a 7z archive", UNPACK),
    b"#ROSBAG": ("a ROS 1 bag", "write its poses as TUM text"), b"\x89MCAP0": ("an MCAP log", "write its poses as TUM text"),
    b"SQLite format 3\0": ("a database (SQLite)", "write its poses as TUM text"),
    b"\x89HDF\r\n": ("an HDF5 file", "write its poses as TUM text"), b"\x93NUMPY": ("a NumPy array", "write its poses as TUM text"),
    b"version https://git-lfs": ("a Git LFS pointer, not the file itself", "fetch the file by 'git lfs pull'"),
    b"<!doctype html": ("a web page", "the download gave a page instead of the file; download it anew"),
    b"<html": ("a web page", "the download gave a page instead of the file; download it anew")}


class EvaluationError(Exception):
    """The work failed; the message names the file, the reason and the remedy."""


class UsageError(Exception):
    """The command line is wrong."""


def occupy_standard_descriptors():
    """A file that is opened must not become the standard output."""
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDONLY)
    if sys.stdout is not None:
        sys.stdout.reconfigure(encoding="utf-8")
    if sys.stderr is not None:
        sys.stderr.reconfigure(encoding="utf-8", errors="backslashreplace")


def excerpt(text, most=60):
    """Text from outside for a message: at most `most` characters, those that are not printable as \\xNN."""
    shown = "".join(c if c.isprintable() else "".join(f"\\x{byte:02x}" for byte in c.encode("utf-8", "surrogateescape"))
                    for c in text[:most])
    return shown + ("..." if len(text) > most else "")


def read_bytes(file):
    """The bytes of a regular file; a pipe is refused without waiting for it."""
    try:
        descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY)
        with open(descriptor, "rb") as stream:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise EvaluationError(f"{file}: cannot be read: it is a pipe or a device; expected a file")
            contents = stream.read(MOST_BYTES + 1)
    except IsADirectoryError:
        raise EvaluationError(f"{file}: cannot be read: it is a folder; expected a file, as trajectory.tum in the folder of a replay") from None
    except OSError as error:
        raise EvaluationError(f"{file}: cannot be read: {error.strerror}") from None
    if len(contents) > MOST_BYTES:
        raise EvaluationError(f"{file}: cannot be read: it is larger than {MOST_BYTES} bytes, the limit for such a file")
    return contents


def read_text(file):
    """The text of a file: UTF-8, or UTF-16 with a byte order mark; other bytes become lone surrogates."""
    contents = read_bytes(file)
    for start, (name, remedy) in FOREIGN.items():
        if contents[:len(start)] == start or start[:1] == b"<" and contents[:len(start)].lower() == start:
            raise EvaluationError(f"{file}: cannot be read: it is {name}: {remedy}")
    if contents[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return contents.decode("utf-16", "replace")
    return contents.removeprefix(b"\xef\xbb\xbf").decode("utf-8", "surrogateescape")


def write_file(file, contents):
    """Writes bytes atomically into a regular or new file, into anything else (/dev/stdout, a FIFO) as it is."""
    check_can_be_written(file)
    target = pathlib.Path(os.path.realpath(file))
    try:
        if os.path.exists(file) and not target.is_file():
            pathlib.Path(file).write_bytes(contents)
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        old_mode = stat.S_IMODE(target.stat().st_mode) if target.exists() else None
        mask = os.umask(0)
        os.umask(mask)
        descriptor, temporary = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        try:
            with open(descriptor, "wb") as stream:
                stream.write(contents)
                stream.flush()
                os.fchmod(descriptor, 0o666 & ~mask if old_mode is None else old_mode)
                os.fsync(descriptor)
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise EvaluationError(f"{file}: cannot be written: {error.strerror}") from None


def check_can_be_written(file):
    """For use before the work; makes nothing."""
    if os.path.isdir(file) or str(file).endswith("/"):
        raise EvaluationError(f"{file}: is a folder; name a file")
    if os.path.exists(file) and not os.access(file, os.W_OK):
        raise EvaluationError(f"{file}: cannot be written: {os.strerror(errno.EACCES)}")
    folder = pathlib.Path(os.path.abspath(file)).parent
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    if not os.path.exists(file) and not (folder.is_dir() and os.access(folder, os.W_OK | os.X_OK)):
        raise EvaluationError(f"{file}: cannot be written: no file can be made in the folder {folder}")


def make_folder(folder):
    try:
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise EvaluationError(f"{folder}: the folder cannot be created: {error.strerror}") from None


def printed(text):
    """Names of files may hold bytes that are not UTF-8: they become U+FFFD."""
    return str(text).encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def warn(message):
    print("cartvo: warning:", excerpt(str(message), 4000), file=sys.stderr)


def print_output(text):
    """Prints to the standard output; raises if it does not receive everything."""
    try:
        if sys.stdout is None:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        sys.stdout.write(printed(text))
        sys.stdout.flush()
    except OSError as error:
        reason = os.strerror(error.errno)
        sys.stdout = None  # Python would report the error once more
        raise EvaluationError(f"standard output cannot be written: {reason}; the output is not complete") from None


def json_text(value):
    """JSON as all commands print it: indented; a value that is no number is null."""
    def clean(part):
        if isinstance(part, dict):
            return {key: clean(inner) for key, inner in part.items()}
        if isinstance(part, (list, tuple)):
            return [clean(inner) for inner in part]
        if isinstance(part, str):
            return printed(part)
        return None if isinstance(part, float) and not math.isfinite(part) else part
    return json.dumps(clean(value), indent=2, ensure_ascii=False) + "\n"


def significant(value):
    """Three significant digits without an exponent: 0.0123, 1.23, 123."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    return f"{value:.{min(max(2 - math.floor(math.log10(abs(value))), 0), 9)}f}"


def text_table(header, rows):
    """Aligned text: the first column to the left, the others to the right."""
    widths = [max(3, *(len(row[i]) for row in [header, *rows])) for i in range(len(header))]
    lines = ("  ".join(cell.ljust(width) if i == 0 else cell.rjust(width) for i, (cell, width) in enumerate(zip(row, widths)))
             for row in [header, *rows])
    return "".join(line.rstrip() + "\n" for line in lines)
