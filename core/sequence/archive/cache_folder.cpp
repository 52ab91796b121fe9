#include "core/sequence/archive/cache_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <vector>

#include "core/error.hpp"
#include "core/hash.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPart = ".part-";
constexpr std::uint64_t kGigabyte = 1'000'000'000;  // bytes, as disks are sold
constexpr double kUsualLimit = 20.0;                // GB: tens of sequences, and a small part of most disks
constexpr std::uint64_t kLeftFree = kGigabyte;      // of the disk
// Bytes: room is made for many files at a time, as looking through the cache is slow.
constexpr std::uint64_t kRoomAtOnce = 256 << 20;

std::uint64_t limit() {
  const char* wish = std::getenv("STILLPOINT_CACHE_GB");
  const double gigabytes = wish != nullptr ? parse_number(wish).value_or(kUsualLimit) : kUsualLimit;
  return static_cast<std::uint64_t>(std::clamp(gigabytes, 0.0, 1e6) * static_cast<double>(kGigabyte));
}

/// This machine, as names of parts have it: letters, digits and underscores.
std::string this_host() {
  std::array<char, 256> name{};
  (void)::gethostname(name.data(), name.size() - 1);
  std::string host = name.data();
  for (char& letter : host)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  return host;
}

/// Whether whoever began a part (`HOST-PROCESS-NUMBER`) goes on with it no more. A home folder may be shared
/// by machines, and of another one's processes only the part's age tells: it grows while it is unpacked.
bool is_left_over(const fs::path& part, const std::string& writer) {
  constexpr auto kForsaken = std::chrono::hours(24);  // far longer than a disk takes for one file of a part
  const auto dash = writer.find('-');
  if (dash == std::string::npos) return false;
  if (writer.substr(0, dash) != this_host()) {
    std::error_code failed;
    const auto touched = fs::last_write_time(part, failed);
    return !failed && fs::file_time_type::clock::now() - touched > kForsaken;
  }
  int process = 0;
  std::from_chars(writer.data() + dash + 1, writer.data() + writer.size(), process);
  return process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
}

/// Takes away what programs that no longer run left half written.
void take_away_parts(const fs::path& folder) {
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().filename().string();
    const auto at = name.rfind(kPart);
    if (at != std::string::npos && is_left_over(entry.path(), name.substr(at + std::strlen(kPart))))
      fs::remove(entry.path(), failed);
  }
}

}  // namespace

fs::path cache_folder() {
  // The XDG base directory specification: a relative path is to be ignored.
  if (const char* chosen = std::getenv("XDG_CACHE_HOME"); chosen != nullptr && chosen[0] == '/')
    return fs::path(chosen) / "stillpoint";
  if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/')
    return fs::path(home) / ".cache" / "stillpoint";
  throw InputError("there is no folder to unpack into: neither XDG_CACHE_HOME nor HOME is set");
}

UnpackedFile::UnpackedFile(const std::string& original, const std::string& ending)
    : original_(original), folder_(cache_folder()), limit_(limit()) {
  struct stat status {};
  if (::stat(original.c_str(), &status) != 0)
    throw InputError(fmt::format("{}: cannot be opened: {}", original, std::strerror(errno)));
  std::error_code failed;
  const fs::path whole = fs::weakly_canonical(original, failed);
  Fingerprint print;
  print.add(failed ? original : whole.string());
  print.add(static_cast<std::uint64_t>(status.st_size));
  print.add(static_cast<std::uint64_t>(status.st_mtim.tv_sec));
  print.add(static_cast<std::uint64_t>(status.st_mtim.tv_nsec));
  path_ = folder_ / (whole.stem().string() + "-" + print.hex() + ending);
}

UnpackedFile::~UnpackedFile() {
  if (file_ < 0) return;
  ::close(file_);
  std::error_code failed;
  fs::remove(part_, failed);
}

std::optional<std::string> UnpackedFile::found() const {
  std::error_code failed;
  if (!fs::is_regular_file(path_, failed)) return std::nullopt;
  // Its time says when it was last used.
  fs::last_write_time(path_, fs::file_time_type::clock::now(), failed);
  return path_.string();
}

void UnpackedFile::begin() {
  static std::atomic<int> count{0};
  std::error_code failed;
  fs::create_directories(folder_, failed);
  take_away_parts(folder_);
  part_ = path_.string() + fmt::format("{}{}-{}-{}", kPart, this_host(), ::getpid(), count++);
  file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file_ < 0) fail(errno);
}

void UnpackedFile::fail(int cause) const {
  throw InputError(
      fmt::format("{}: cannot be unpacked into {}: {}; XDG_CACHE_HOME may name a folder elsewhere", original_,
                  folder_.string(), std::strerror(cause)));
}

void UnpackedFile::make_room(std::uint64_t bytes) {
  if (written_ + bytes > limit_)
    throw InputError(fmt::format(
        "{}: unpacked it takes more than the {:g} GB that the cache in {} may hold; "
        "STILLPOINT_CACHE_GB says otherwise",
        original_, static_cast<double>(limit_) / static_cast<double>(kGigabyte), folder_.string()));
  struct Kept {
    fs::path path;
    fs::file_time_type used;
    std::uint64_t size;
  };
  std::vector<Kept> kept;
  std::uint64_t all = 0;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder_, failed)) {
    std::error_code gone;
    const std::uint64_t size = entry.file_size(gone);
    if (gone) continue;
    all += size;
    if (entry.path().string().find(kPart) == std::string::npos)
      kept.push_back({entry.path(), entry.last_write_time(gone), size});
  }
  std::sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) { return a.used < b.used; });
  const auto is_full = [&] {
    const fs::space_info space = fs::space(folder_, failed);
    return all + bytes > limit_ || (!failed && space.available < bytes + kLeftFree);
  };
  for (auto oldest = kept.begin(); oldest != kept.end() && is_full(); ++oldest) {
    std::error_code gone;
    if (fs::remove(oldest->path, gone)) all -= oldest->size;
  }
  const fs::space_info space = fs::space(folder_, failed);
  if (!failed && space.available < bytes + kLeftFree) fail(ENOSPC);
  room_ = bytes;
}

void UnpackedFile::write(ByteView bytes) {
  if (bytes.size() > room_)
    make_room(
        std::max<std::uint64_t>(bytes.size(), std::min(kRoomAtOnce, limit_ - std::min(limit_, written_))));
  room_ -= bytes.size();
  while (!bytes.empty()) {
    const ssize_t done = ::write(file_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail(errno);
    written_ += static_cast<std::uint64_t>(done);
    bytes = bytes.subspan(static_cast<std::size_t>(done));
  }
}

void UnpackedFile::write_at(std::uint64_t offset, ByteView bytes) {
  if (::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset)) !=
      static_cast<ssize_t>(bytes.size()))
    fail(errno);
}

std::string UnpackedFile::keep() {
  ::close(file_);
  file_ = -1;
  std::error_code failed;
  fs::rename(part_, path_, failed);
  if (failed) {
    std::error_code ignored;
    fs::remove(part_, ignored);
    fail(failed.value());
  }
  return path_.string();
}

}  // namespace stillpoint
