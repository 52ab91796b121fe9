#include "core/sequence/write_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "core/error.hpp"
#include "core/out_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kImageFolders[] = {"rgb", "depth", "mask"};
constexpr const char* kTextFiles[] = {"rgb.txt",         "depth.txt",        "mask.txt",
                                      "groundtruth.txt", "associations.txt", "camera.toml"};

void write_bytes(const fs::path& path, const void* bytes, std::size_t size) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  file.close();  // a full disk may show only now
  if (!file)
    throw InputError(fmt::format("{} cannot be written: {}", path.string(),
                                 errno != 0 ? std::strerror(errno) : "unknown reason"));
}

void write_png(const fs::path& path, const cv::Mat& image) {
  // Noise hardly packs better at higher levels, and packing must keep up with rendering.
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1}))
    throw InputError(fmt::format("{} cannot be packed as PNG", path.string()));
  write_bytes(path, bytes.data(), bytes.size());
}

bool holds_sequence(const fs::path& folder) {
  const auto there = [&](const char* name) {
    std::error_code error;
    return fs::exists(folder / name, error);
  };
  return std::any_of(std::begin(kTextFiles), std::end(kTextFiles), there) ||
         std::any_of(std::begin(kImageFolders), std::end(kImageFolders), there);
}

/// Removes what write_sequence writes and nothing else.
void clear_sequence(const fs::path& folder) {
  for (const char* name : kTextFiles) fs::remove(folder / name);
  for (const char* name : kImageFolders) {
    if (!fs::is_directory(folder / name)) continue;
    std::vector<fs::path> images;
    for (const auto& entry : fs::directory_iterator(folder / name))
      if (entry.is_regular_file() && entry.path().extension() == ".png") images.push_back(entry.path());
    for (const fs::path& image : images) fs::remove(image);
  }
}

void prepare(const FrameSource& source, const fs::path& folder, bool force) {
  try {
    if (fs::exists(folder) && !fs::is_directory(folder))
      throw InputError(
          fmt::format("{} is a file, expected a folder to write the sequence to", folder.string()));
    if (holds_sequence(folder)) {
      if (!force)
        throw InputError(
            fmt::format("{} holds a sequence already; give --force to replace it", folder.string()));
      clear_sequence(folder);
    }
    fs::create_directories(folder / "rgb");
    if (source.has_depth()) fs::create_directories(folder / "depth");
    if (source.has_masks()) fs::create_directories(folder / "mask");
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{} cannot be written to: {}", folder.string(), error.code().message()));
  }
}

std::string image_name(double stamp) { return fmt::format("{:.6f}.png", stamp); }

/// @returns when the depth image was taken, s; nothing where there is none
std::optional<double> write_frame(const FrameSource& source, int index, const fs::path& folder) {
  const Frame frame = source.read(index);
  if (!frame.readable())
    throw InputError(fmt::format("frame {} of {}: {}", index, source.name(), frame.problem));
  const std::string name = image_name(source.timestamp(index));
  write_png(folder / "rgb" / name, frame.colour.empty() ? frame.gray : frame.colour);
  if (source.has_masks())
    if (const FrameTruth truth = source.truth(index); !truth.moving.empty())
      write_png(folder / "mask" / name, truth.moving);
  if (!frame.has_depth()) return std::nullopt;
  cv::Mat stored;
  frame.depth.convertTo(stored, CV_16U, source.camera().depth_scale);  // rounds to nearest
  write_png(folder / "depth" / image_name(frame.depth_timestamp), stored);
  return frame.depth_timestamp;
}

/// All frames, by as many threads as wanted; the first failure ends them and is thrown.
/// When each frame's depth was taken, of the frames written: those from the first on.
using DepthStamps = std::vector<std::optional<double>>;

/// All frames, by as many threads as wanted; the first failure ends them and is thrown.
DepthStamps write_frames(const FrameSource& source, const fs::path& folder, const WriteOptions& options) {
  std::atomic<int> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;  // of done and failure
  int done = 0;
  std::exception_ptr failure;
  DepthStamps depth_stamps(static_cast<std::size_t>(source.size()));
  const auto work = [&] {
    // Whoever has taken a frame writes it, so that none is missing before the last.
    while (!failed && !(options.stop != nullptr && *options.stop)) {
      const int i = next++;
      if (i >= source.size()) break;
      try {
        depth_stamps[static_cast<std::size_t>(i)] = write_frame(source, i, folder);
        const std::lock_guard lock(mutex);
        ++done;
        if (options.progress) options.progress(done, source.size());
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        failed = true;
      }
    }
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < std::clamp(options.threads, 1, 64); ++i) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
  depth_stamps.resize(static_cast<std::size_t>(done));
  return depth_stamps;
}

std::string camera_text(const Camera& c) {
  return fmt::format(
      "name = \"{}\"\nwidth = {}\nheight = {}\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n"
      "k1 = {}\nk2 = {}\np1 = {}\np2 = {}\nk3 = {}\ndepth_scale = {}\nreadout_s = {}\n",
      c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, c.depth_scale,
      c.readout_s);
}

void write_lists(const FrameSource& source, const fs::path& folder, const DepthStamps& depth_stamps) {
  const auto list = [&](const char* name, auto&& stamp_of) {
    std::string text = fmt::format("# {} images of {}\n# timestamp filename\n", name, source.name());
    for (int i = 0; i < source.size(); ++i)
      if (const std::optional<double> stamp = stamp_of(i);
          stamp && fs::exists(folder / name / image_name(*stamp)))
        text += fmt::format("{:.6f} {}/{}\n", *stamp, name, image_name(*stamp));
    write_text_file(folder / (std::string(name) + ".txt"), text);
  };
  const auto of_colour = [&](int i) { return std::optional(source.timestamp(i)); };
  const auto of_depth = [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    return at < depth_stamps.size() ? depth_stamps[at] : std::nullopt;
  };
  write_text_file(folder / "camera.toml", camera_text(source.camera()));
  if (!source.ground_truth().empty())
    write_tum_trajectory((folder / "groundtruth.txt").string(), source.ground_truth());
  if (source.has_masks()) list("mask", of_colour);
  if (source.has_depth()) {
    list("depth", of_depth);
    std::string pairs;
    for (int i = 0; i < source.size(); ++i)
      if (const auto stamp = of_depth(i))
        pairs += fmt::format("{0:.6f} rgb/{1} {2:.6f} depth/{3}\n", source.timestamp(i),
                             image_name(source.timestamp(i)), *stamp, image_name(*stamp));
    write_text_file(folder / "associations.txt", pairs);
  }
  list("rgb", of_colour);
}

}  // namespace

int write_sequence(const FrameSource& source, const fs::path& folder, const WriteOptions& options) {
  if (source.size() == 0) throw InputError(fmt::format("{} has no frames to write", source.name()));
  prepare(source, folder, options.force);
  const DepthStamps written = write_frames(source, folder, options);
  if (!written.empty()) write_lists(source, folder, written);
  return static_cast<int>(written.size());
}

}  // namespace stillpoint
