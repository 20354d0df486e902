"""Names that C++ sources of this project define, and sources that can be compiled as one."""
import re

# A definition in a source begins a line, because namespaces are not indented.
TYPE = re.compile(r"^(?:template <.*> )?(?:struct|class|enum(?: class)?) (\w+)", re.MULTILINE)
FUNCTION_OR_VARIABLE = re.compile(
    r"^(?:\[\[\w+\]\] )?(?=[A-Za-z])(?!namespace|using ::|struct|class|enum|TEST|INSTANT)"
    r"(?:[\w:<>,&*\[\]() ]+?[ &*])?(\w+)(?=\(| =|\{| \{|;|\[)", re.MULTILINE)
CONSTANT = re.compile(r"\bk[A-Z]\w*")
CONSTANTS = re.compile(r"^constexpr .*$", re.MULTILINE)
USED = re.compile(r"^using (?:\w+::)+(\w+);", re.MULTILINE)


def defined_names(text: str) -> set[str]:
    """The names that the source `text` defines."""
    names = set(TYPE.findall(text)) | set(FUNCTION_OR_VARIABLE.findall(text)) - {"const", "noexcept"}
    for line in CONSTANTS.findall(text):
        names.update(CONSTANT.findall(line))
    return names


def used_names(text: str) -> set[str]:
    """Names of other namespaces, and of constants, that the source `text` uses, or gives to a local constant."""
    return set(USED.findall(text)) | set(CONSTANT.findall(text))


def compatible_groups(sources, largest: int) -> list[list]:
    """Groups of at most `largest` sources of which none defines a name that another one defines or uses. Each of `sources`:
    the source, and anything that must be the same in a group. Keeps the order: the same sources give the same groups."""
    groups: list[tuple[object, set[str], set[str], list]] = []
    for source, kind in sources:
        text = source.read_text()
        defined = defined_names(text) - set(USED.findall(text))
        used = used_names(text) - defined
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
