"""Names that C++ sources of this project define, and sources that can be compiled as one."""
import re

# Names that a source defines at the beginning of a line, because namespaces are not indented. Takes too many rather than
# too few: of a function also the last parameter with a default.
BEGIN = r"^(?:\[\[\w+\]\] )?(?=[A-Za-z])(?!namespace|using ::|struct|class|enum|TEST|INSTANT)"
END = r"[ &*])?(\w+)(?=\(| =|\{| \{|;|\[)"
DEFINED = [re.compile(BEGIN + r"(?:[\w:<>,&*\[\]() ]+" + END, re.MULTILINE),
           re.compile(BEGIN + r"(?:[\w:<>,&*\[\]() ]+?" + END, re.MULTILINE),
           re.compile(r"^(?:template <.*> )?(?:struct|class|enum(?: class)?) (\w+)", re.MULTILINE)]
CONSTANTS = re.compile(r"^constexpr .*$", re.MULTILINE)
CONSTANT = re.compile(r"\bk[A-Z]\w*(?= =|\{|\[)")
USED = re.compile(r"^using (?:\w+::)+(\w+);", re.MULTILINE)


def defined_names(text: str) -> set[str]:
    """The names that the source `text` defines."""
    names = {name for pattern in DEFINED for name in pattern.findall(text)} - {"const", "noexcept"}
    for line in CONSTANTS.findall(text):
        names.update(CONSTANT.findall(line))
    return names


def compatible_groups(sources, largest: int) -> list[list]:
    """Groups of at most `largest` sources that define no name in common, and none that another uses from another namespace.
    Each of `sources`: the source, and anything that must be the same in a group. Keeps the order, so that the same sources
    give the same groups."""
    groups: list[tuple[object, set[str], set[str], list]] = []
    for source, kind in sources:
        text = source.read_text()
        used = set(USED.findall(text))
        defined = defined_names(text) - used
        for group_kind, group_defined, group_used, members in groups:
            if group_kind == kind and len(members) < largest and defined.isdisjoint(group_defined | group_used) \
                    and used.isdisjoint(group_defined):
                group_defined |= defined
                group_used |= used
                members.append(source)
                break
        else:
            groups.append((kind, defined, used, [source]))
    return [members for *_, members in groups]
