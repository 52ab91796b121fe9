#pragma once

#include <string>

namespace stillpoint {

/// Packs a folder by libarchive, for tests.
/// @param kind "tar", "gnutar", "tgz", "tar.bz2", "tar.xz", "zip" (deflated), "zip_stored", "7z"
/// @param top the folder that all files lie in; empty = none
void write_archive(const std::string& path, const std::string& folder, const std::string& kind,
                   const std::string& top);

}  // namespace stillpoint
