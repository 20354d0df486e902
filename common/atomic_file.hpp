#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

// Writing of files that the user or the configuration names.

namespace cartvo {

/// Writes a file. Symbolic links are followed.
///
/// A regular file, and one that does not exist, is written atomically: into a temporary file in its folder
/// (see TemporaryFile), which is synced before it takes the name. A reader, or a system after a power cut,
/// finds either all of the old contents or all of the new ones. An existing file keeps its mode and owner; a
/// new one has those of the umask.
///
/// All else is opened and written: character devices, FIFOs, open descriptors of this process (/dev/stdout,
/// /dev/fd/N; standard output is flushed first), and regular files that a replacement would cut off: those
/// with several names, with extended attributes (access control lists), of an owner that this process cannot
/// give, that are mount points, or in a folder that does not allow it.
///
/// Throws std::runtime_error naming the file and the reason, also for a folder, a socket, a block device and
/// a write-protected file.
void writeFileAtomically(const std::filesystem::path& file, std::string_view contents);

/// As `writeFileAtomically`, for a file that the user names: missing folders are made.
void writeResultFile(const std::filesystem::path& file, std::string_view contents);

/// Throws as `writeResultFile` would, for use before long work. Leaves everything as it was.
void checkFileCanBeWritten(const std::filesystem::path& file);

/// Creates a folder and those above it that are missing. Returns the created ones, outermost first. Throws
/// std::runtime_error naming the folder and the reason.
std::vector<std::filesystem::path> createFolders(const std::filesystem::path& folder);

}  // namespace cartvo
