#pragma once

#include <memory>
#include <string>

#include "core/sequence/file_store.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// Whether a file's first bytes are those of an archive, or of a compressed file that may hold one or a bag.
[[nodiscard]] bool is_packed(const std::string& path);

/// A file that is read in place of a packed one: itself, where its parts can be read as they lie (a tar
/// archive, a zip of stored and deflated files); otherwise what libarchive makes of it, in the cache
/// (cache_folder.hpp).
struct Unpacked {
  std::string path;
  bool is_copy = false;
};
/// @throws InputError in one sentence for what cannot be unpacked
[[nodiscard]] Unpacked unpack(const std::string& path, const OpenOptions& options);

/// The files of an archive, or of the one folder that holds all it has.
/// @param unpacked a tar or zip archive; @param original as messages name it
/// @throws InputError in one sentence for what is none
[[nodiscard]] std::unique_ptr<FileStore> open_archive(const std::string& unpacked,
                                                      const std::string& original);

}  // namespace stillpoint
