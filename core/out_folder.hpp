#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace stillpoint {

/// Makes a folder for results, with its parents.
/// @param signs files by which earlier results are known
/// @param force overwrite them
/// @throws InputError when it is a file, cannot be made or written, or holds earlier results and `force` is
/// not set
void prepare_out_folder(const std::filesystem::path& folder, std::initializer_list<std::string_view> signs,
                        bool force);

/// Writes a whole text file.
/// @throws InputError when it cannot be written whole: no rights, a full disk.
void write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace stillpoint
