#include "core/sequence/archive/archive_store.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/sequence/archive/archive_index.hpp"
#include "core/sequence/bag/byte_reader.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

// Bytes unpacked, a hundred times an image's: what claims more is damaged, or meant to fill the memory.
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 30;

/// Folders whose images are a sequence's: what holds one of these alone is the sequence's folder itself.
const std::set<std::string>& part_names() {
  static const std::set<std::string> names = {"rgb",   "color",         "colour", "image", "images",
                                              "depth", "aligned_depth", "mask",   "masks"};
  return names;
}

/// @return why it cannot be, as the end of a sentence
std::string inflate_file(ByteView packed, const ArchivedFile& file, Bytes& bytes) {
  if (file.unpacked > kLargestFile) return "is too large";
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return "cannot be unpacked: no memory";
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  // Deflate packs a thousandfold at most, so that what is claimed is what may be allocated.
  bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(file.unpacked, 1100 * packed.size() + 64)));
  stream.next_in = const_cast<unsigned char*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = bytes.data();
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int state = inflate(&stream, Z_FINISH);
  if (state != Z_STREAM_END || stream.avail_out != 0) return "is damaged in its archive";
  if (crc32_z(0, bytes.data(), bytes.size()) != file.checksum) return "is damaged (a checksum is wrong)";
  return {};
}

class Archive final : public FileStore {
 public:
  Archive(const std::string& unpacked, std::string original)
      : file_(unpacked), original_(std::move(original)), place_(original_) {
    const Bytes start = file_.read(0, 2);
    const bool is_zip = start.size() == 2 && start[0] == 'P' && start[1] == 'K';
    auto index = is_zip ? read_zip_index(file_) : read_tar_index(file_);
    if (!index) throw InputError(fmt::format("{}: is no archive that can be read", original_));
    if (index->is_cut)
      warnings_.push_back(fmt::format("{}: is cut off or damaged; the {} before that were read", original_,
                                      counted(index->files.size(), "file")));
    if (index->files.empty()) throw InputError(fmt::format("{}: is an archive without files", original_));
    files_ = std::move(index->files);
    for (const auto& [name, file] : files_) add_folders(name);
    find_root();
  }

  [[nodiscard]] const std::string& place() const override { return place_; }
  [[nodiscard]] std::vector<std::string> own_names() const override {
    std::vector<std::string> names;
    for (fs::path folder = root_; !folder.empty(); folder = folder.parent_path())
      names.push_back(folder.filename().string());
    const fs::path whole = fs::absolute(original_).lexically_normal();
    fs::path stem = whole.stem();
    if (stem.extension() == ".tar") stem = stem.stem();
    names.push_back(stem.string());
    names.push_back(whole.parent_path().filename().string());
    return names;
  }
  [[nodiscard]] bool is_there(const std::string& name) const override {
    return is_file(name) || is_folder(name);
  }
  [[nodiscard]] bool is_file(const std::string& name) const override { return files_.contains(inside(name)); }
  [[nodiscard]] bool is_folder(const std::string& name) const override {
    return folders_.contains(inside(name));
  }
  [[nodiscard]] std::vector<std::string> entries(const std::string& folder) const override {
    const auto found = folders_.find(inside(folder));
    return found == folders_.end() ? std::vector<std::string>()
                                   : std::vector<std::string>(found->second.begin(), found->second.end());
  }
  [[nodiscard]] std::string why_no_bytes(const std::string& name) const override {
    const auto found = files_.find(inside(name));
    if (found == files_.end()) return is_folder(name) ? "is no file" : "is missing";
    return found->second.size == 0 ? "is empty (0 bytes)" : "";
  }
  [[nodiscard]] std::string read(const std::string& name, Bytes& bytes) const override {
    const auto found = files_.find(inside(name));
    if (found == files_.end()) return is_folder(name) ? "is no file" : "is missing";
    const ArchivedFile& file = found->second;
    if (file.size > kLargestFile) return "is too large";
    bytes = file_.read(file.offset, file.size);
    if (bytes.size() < file.size) return "is truncated";
    if (file.is_deflated) {
      const Bytes packed = std::move(bytes);
      bytes.clear();
      if (std::string fault = inflate_file(packed, file, bytes); !fault.empty()) return fault;
    }
    return bytes.empty() ? "is empty (0 bytes)" : "";
  }
  [[nodiscard]] std::string read_text(const std::string& name) const override {
    Bytes bytes;
    const std::string fault = read(name, bytes);
    if (!fault.empty() && !fault.starts_with("is empty"))
      throw InputError(fmt::format("{} {}", path_of(name), fault));
    return {bytes.begin(), bytes.end()};
  }
  [[nodiscard]] std::string path_of(const std::string& name) const override {
    return name.empty() ? place_ : place_ + "/" + name;
  }
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }

 private:
  void add_folders(const std::string& name) {
    std::string child = name;
    while (true) {
      const auto slash = child.rfind('/');
      const std::string parent = slash == std::string::npos ? "" : child.substr(0, slash);
      if (!folders_[parent].insert(slash == std::string::npos ? child : child.substr(slash + 1)).second)
        return;
      if (parent.empty()) return;
      child = parent;
    }
  }

  /// Into folders that hold all there is.
  void find_root() {
    while (true) {
      const std::set<std::string>& names = folders_.at(root_);
      const std::string& only = *names.begin();
      if (names.size() != 1 || part_names().contains(only)) break;
      const std::string inner = root_.empty() ? only : root_ + "/" + only;
      if (!folders_.contains(inner)) break;
      root_ = inner;
    }
    if (!root_.empty()) place_ += "/" + root_;
  }

  /// A name in the whole archive.
  [[nodiscard]] std::string inside(const std::string& name) const {
    if (name.empty()) return root_;
    const std::string plain = archived_name(name);
    return root_.empty() ? plain : root_ + "/" + plain;
  }

  RandomFile file_;
  std::string original_, place_, root_;
  std::map<std::string, ArchivedFile> files_;
  std::map<std::string, std::set<std::string>> folders_;  ///< by name, what lies in them
  std::vector<std::string> warnings_;
};

}  // namespace

std::string archived_name(std::string name) {
  name = printable(std::move(name));
  std::replace(name.begin(), name.end(), '\\', '/');
  name = fs::path(name).lexically_normal().relative_path().string();
  while (name.ends_with('/')) name.pop_back();
  if (name.empty() || name == "." || name == ".." || name.starts_with("../") || name.starts_with("__MACOSX/"))
    return {};
  const std::string file = name.substr(name.rfind('/') + 1);
  return file.starts_with("._") || file == ".DS_Store" ? std::string() : name;
}

std::unique_ptr<FileStore> open_archive(const std::string& unpacked, const std::string& original) {
  return std::make_unique<Archive>(unpacked, original);
}

}  // namespace stillpoint
