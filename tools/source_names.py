"""Names that C++ sources of this project define, and sources that can be compiled as one."""
import re

# A name that a source defines: at the beginning of a line, because namespaces are not indented.
DEFINED = re.compile(r"^(?:\[\[\w+\]\] )?(?=[A-Za-z])(?!namespace|using ::|TEST|INSTANT)(?:[\w:<>,&*\[\]() ]+[ &*])?(\w+)(?=\(| =|\{| \{|;|\[)",
                     re.MULTILINE)
FURTHER_CONSTANT = re.compile(r"^constexpr .*$", re.MULTILINE)
CONSTANT = re.compile(r"\bk[A-Z]\w*(?= =|\{|\[)")


def defined_names(text: str) -> set[str]:
    """The names that the source `text` defines."""
    names = set(DEFINED.findall(text)) - {"const", "noexcept"}
    for line in FURTHER_CONSTANT.findall(text):
        names.update(CONSTANT.findall(line))
    return names


def compatible_groups(sources, largest: int) -> list[list]:
    """Groups of at most `largest` sources that define no name in common. Each of `sources`: the source, and anything that
    must be the same in a group. Keeps the order, so that the same sources give the same groups."""
    groups: list[tuple[object, set[str], list]] = []
    for source, kind in sources:
        names = defined_names(source.read_text())
        for group_kind, group_names, members in groups:
            if group_kind == kind and len(members) < largest and names.isdisjoint(group_names):
                group_names |= names
                members.append(source)
                break
        else:
            groups.append((kind, names, [source]))
    return [members for _, _, members in groups]
