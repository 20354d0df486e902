#!/usr/bin/env python3
"""unity_groups.py LIST OUTPUT: groups sources for CARTVO_UNITY (CMakeLists.txt).

Each line of the file LIST is a target and its sources, separated by semicolons. Writes to OUTPUT the CMake commands that
compile sources of a target together which define no name in common.
"""
import pathlib
import sys

from source_names import compatible_groups

MAX_GROUP_SIZE = 8  # sources: the compiler needs about 1 GB for them


def main() -> None:
    lines = pathlib.Path(sys.argv[1]).read_text().splitlines()
    output = []
    for line in lines:
        target, *sources = line.split(";")
        groups = compatible_groups([(pathlib.Path(source), None) for source in sources], MAX_GROUP_SIZE)
        for index, members in enumerate(groups):
            if len(members) > 1:
                paths = " ".join(f'"{member}"' for member in members)
                output.append(f"set_source_files_properties({paths} TARGET_DIRECTORY {target}\n"
                              f"  PROPERTIES UNITY_GROUP {target}_{index})\n")
    pathlib.Path(sys.argv[2]).write_text("".join(output))


if __name__ == "__main__":
    main()
