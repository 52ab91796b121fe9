#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "core/error.hpp"
#include "core/sequence/archive/archive_store.hpp"
#include "core/sequence/bag/bag_input.hpp"
#include "core/sequence/bag/random_file.hpp"
#include "core/sequence/bag/unpack_bag.hpp"
#include "core/sequence/first_frames.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/listed_sequence.hpp"
#include "core/sequence/source.hpp"
#include "core/sequence/video/video_input.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// The recording of messages that a file is by its first bytes. @param path names it in messages
std::unique_ptr<MessageLog> open_log(const std::string& file, const std::string& path,
                                     const OpenOptions& options) {
  const Bytes start = RandomFile(file, path).read(0, 16);
  const std::string_view magic(reinterpret_cast<const char*>(start.data()), start.size());
  if (magic.starts_with("#ROSBAG V2.0") && is_slow_bag(file))
    return open_ros1_bag(unpacked_bag(file, options), path);
  if (magic.starts_with("#ROS")) return open_ros1_bag(file, path);
  if (magic.starts_with("\x89MCAP")) return open_mcap(file, path);
  if (magic.starts_with("SQLite format 3")) return open_rosbag2_db3(file, path);
  return nullptr;
}

/// The recordings of rosbag2's folder: the files beside its metadata.
std::vector<std::string> recordings_in(const std::string& folder) {
  std::error_code none;
  std::vector<std::string> files;
  if (!fs::exists(fs::path(folder) / "metadata.yaml", none)) return files;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const fs::path kind = entry.path().extension();
    if (kind == ".mcap" || kind == ".db3") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::unique_ptr<SequenceInput> open_file(const std::string& where, const OpenOptions& options) {
  std::error_code none;
  if (auto log = open_log(where, where, options)) return make_bag_input(std::move(log), options);
  if (is_video(where)) {
    if (!options.topics.empty())
      throw InputError(fmt::format("{}: --topics goes with a bag, and this is a video", where));
    return make_video_input(where, options);
  }
  if (!is_packed(where))
    throw InputError(
        fmt::format("{}: is {} file, expected a folder in the TUM RGB-D layout, an archive of one (.tgz, .tar, "
                    ".tar.bz2, .zip), a bag (.bag, .mcap, .db3), or a video (.mp4, .mkv, .avi)",
                    where, fs::is_empty(where, none) ? "an empty" : "a"));
  const Unpacked unpacked = unpack(where, options);
  if (unpacked.is_copy)
    if (auto log = open_log(unpacked.path, where, options)) return make_bag_input(std::move(log), options);
  if (!options.topics.empty())
    throw InputError(fmt::format("{}: --topics goes with a bag, and this is an archive", where));
  return make_folder_input(open_archive(unpacked.path, where), options);
}

std::unique_ptr<SequenceInput> open_input(const std::string& where, const OpenOptions& options) {
  std::error_code none;
  if (fs::is_regular_file(where, none)) return open_file(where, options);
  if (const auto recordings = recordings_in(where); !recordings.empty()) {
    if (recordings.size() > 1)
      throw InputError(
          fmt::format("{}: is a recording in {} parts; each is opened by its own name, such as {}", where,
                      recordings.size(), recordings.front()));
    if (auto log = open_log(recordings.front(), recordings.front(), options))
      return make_bag_input(std::move(log), options);
  }
  if (!options.topics.empty())
    throw InputError(fmt::format("{}: --topics goes with a bag, and this is a folder", where));
  return make_folder_input(open_folder(where), options);
}

/// What is told quotes what the input holds, a name or a key, whose control characters must not part the
/// sentence.
std::unique_ptr<FrameSource> open_recorded(const std::string& where, const OpenOptions& options) {
  try {
    return std::make_unique<ListedSequence>(open_input(where, options), options);
  } catch (const InputError& error) {
    if (const std::string line = printable(error.what()); line != error.what()) throw InputError(line);
    throw;
  }
}

}  // namespace

bool is_sequence_file(const std::string& path) {
  std::error_code none;
  if (!fs::is_regular_file(path, none)) return false;
  const Bytes start = RandomFile(path).read(0, 16);
  const std::string_view magic(reinterpret_cast<const char*>(start.data()), start.size());
  return magic.starts_with("#ROS") || magic.starts_with("\x89MCAP") || magic.starts_with("SQLite format 3") ||
         is_packed(path) || is_video(path);
}

std::unique_ptr<FrameSource> open_sequence(const std::string& where, const OpenOptions& options) {
  constexpr std::string_view kGenerated = "generated:";
  if (where.starts_with(kGenerated))
    return make_generated_sequence(where.substr(kGenerated.size()), options.frames, options.seed,
                                   options.stereo, options.camera);
  auto recorded = open_recorded(where, options);
  if (options.frames < 0)
    throw InputError(fmt::format("{}: expected a number of frames, not {}", where, options.frames));
  if (options.frames == 0) return recorded;
  return first_frames(std::move(recorded), options.frames);
}

}  // namespace stillpoint
