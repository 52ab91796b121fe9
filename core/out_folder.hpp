#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// Makes a folder for results, with its parents.
/// @param signs files by which earlier results are known
/// @param force overwrite them
/// @throws InputError when it is a file, cannot be made or written, or holds earlier results and `force` is
/// not set
void prepare_out_folder(const std::filesystem::path& folder, std::initializer_list<std::string_view> signs,
                        bool force);

/// Folders that are made for results after this: where nothing has come to lie in them they go with it, so
/// that what was refused leaves nothing behind.
class NewFolders {
 public:
  explicit NewFolders(const std::filesystem::path& folder);
  ~NewFolders();
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;

 private:
  std::vector<std::filesystem::path> missing_;  // when it began; the innermost first
};

/// Asks, before any work, what would keep a file from being written in the end.
/// @param force replace a file of that name
/// @throws InputError when it is a folder, is there already and `force` is not set, or when its folder is
/// missing or cannot be written to
void check_out_file(const std::filesystem::path& file, bool force);

/// A file that takes its name once it is whole: until keep() it is written beside, as PATH.part, and what was
/// there before stays, whatever ends the program. Links are followed; what is no regular file (a device, a
/// pipe) is written to as it is.
class WholeFile {
 public:
  /// @param ending of the name while it is written, for writers that go by it: ".mp4"
  explicit WholeFile(std::filesystem::path path, std::string_view ending = {});
  /// What was not kept goes away.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  /// Where it is to be written.
  [[nodiscard]] const std::filesystem::path& while_written() const { return part_; }
  /// It is whole. @throws InputError when it cannot take its name
  void keep();

 private:
  std::filesystem::path path_, part_;
  bool kept_ = false;
};

/// Files that take their names together, once all of them are whole.
class WholeFiles {
 public:
  /// @param ending as WholeFile has it
  /// @throws InputError when it cannot be written; none has taken its name then
  void add(const std::filesystem::path& path, std::string_view text, std::string_view ending = {});
  /// One that is too long to be held in memory. @param write puts it into the file, piece by piece
  void add(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write,
           std::string_view ending = {});
  /// @throws InputError when one cannot take its name
  void keep();

 private:
  std::deque<WholeFile> files_;
};

/// Writes a file, whole or not at all.
/// @param ending as WholeFile has it: of its own where several processes may write the same file
/// @throws InputError when it cannot be written whole: no rights, a full disk.
void write_text_file(const std::filesystem::path& path, std::string_view text, std::string_view ending = {});

}  // namespace stillpoint
