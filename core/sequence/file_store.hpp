#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/sequence/image_file.hpp"

namespace stillpoint {

/// Where a sequence's files lie: a folder, or an archive that is read as it was downloaded. Names are
/// relative to it, with slashes. Reading is const and safe from several threads at once.
class FileStore {
 public:
  virtual ~FileStore() = default;

  /// As messages name it.
  [[nodiscard]] virtual const std::string& place() const = 0;
  /// Names that may tell the camera, the nearest first: the folder's own, its parent's, an archive's.
  [[nodiscard]] virtual std::vector<std::string> own_names() const = 0;
  /// Whether there is a file or a folder of that name.
  [[nodiscard]] virtual bool is_there(const std::string& name) const = 0;
  [[nodiscard]] virtual bool is_file(const std::string& name) const = 0;
  [[nodiscard]] virtual bool is_folder(const std::string& name) const = 0;
  /// The names of what lies directly in a folder ("" = the store itself), without the folder, in order.
  [[nodiscard]] virtual std::vector<std::string> entries(const std::string& folder) const = 0;
  /// What read() would say of a file that is missing or empty, by a look at its entry alone; empty otherwise.
  [[nodiscard]] virtual std::string why_no_bytes(const std::string& name) const = 0;
  /// @return why there are no bytes, as the end of a sentence that begins with path_of(name); empty when all
  /// is well
  [[nodiscard]] virtual std::string read(const std::string& name, Bytes& bytes) const = 0;
  /// @throws InputError for a text that cannot be read
  [[nodiscard]] virtual std::string read_text(const std::string& name) const = 0;
  /// A file's name as messages have it.
  [[nodiscard]] virtual std::string path_of(const std::string& name) const = 0;
  /// What is to be told of the store itself: that it is cut off, ….
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
};

/// @throws InputError in one sentence for a folder that is none or cannot be opened
[[nodiscard]] std::unique_ptr<FileStore> open_folder(const std::string& folder);

}  // namespace stillpoint
