#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/sequence/bag/random_file.hpp"

namespace stillpoint {

/// Where a file lies in an archive.
struct ArchivedFile {
  std::uint64_t offset = 0;    ///< of its bytes
  std::uint64_t size = 0;      ///< bytes there
  std::uint64_t unpacked = 0;  ///< bytes of the file itself, as claimed
  bool is_deflated = false;    ///< otherwise it is stored as it is
  std::uint32_t checksum = 0;  ///< CRC-32 of a deflated one
};

/// What an archive holds: files by their names, with slashes and without "./". Names that lead out of the
/// archive and what file managers add (`__MACOSX/`, `._NAME`) are left out.
struct ArchiveIndex {
  std::map<std::string, ArchivedFile> files;
  bool is_cut = false;  ///< it ends before its end
};

/// An archive's name as an index has it, empty for one to be left out.
[[nodiscard]] std::string archived_name(std::string name);

/// The files of an uncompressed tar archive: ustar, GNU's and POSIX' long names, links to files in it.
/// @return nothing where its first record is none
[[nodiscard]] std::optional<ArchiveIndex> read_tar_index(const RandomFile& file);

/// The files of a zip archive by the directory at its end, which may be ZIP64's.
/// @return nothing where there is no such directory, or a file in it is packed otherwise than deflated or is
/// encrypted
[[nodiscard]] std::optional<ArchiveIndex> read_zip_index(const RandomFile& file);

}  // namespace stillpoint
