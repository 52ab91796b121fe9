#include "core/sequence/write_sequence.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "core/error.hpp"
#include "core/media/image_codec.hpp"
#include "core/media/stored_depth.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/rgbd/rgbd_recording.hpp"
#include "core/sequence/stereo/write_stereo.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// All that may be written, whatever the layout.
std::vector<std::string> image_folders() {
  std::vector<std::string> folders = stereo_image_folders();
  folders.insert(folders.end(), {"rgb", "depth", "mask"});
  return folders;
}
std::vector<std::string> text_files() {
  std::vector<std::string> files = stereo_text_files();
  files.insert(files.end(),
               {"rgb.txt", "depth.txt", "mask.txt", "groundtruth.txt", "associations.txt", "camera.toml"});
  return files;
}

void write_png(const fs::path& path, const cv::Mat& image) {
  const std::vector<std::uint8_t> bytes = encode_camera_png(image);
  if (bytes.empty()) throw InputError(fmt::format("{} cannot be packed as PNG", path.string()));
  write_text_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

bool holds_sequence(const fs::path& folder) {
  const auto there = [&](const std::string& name) {
    std::error_code error;
    return fs::exists(folder / name, error);
  };
  const auto texts = text_files(), images = image_folders();
  return std::any_of(texts.begin(), texts.end(), there) || std::any_of(images.begin(), images.end(), there) ||
         !rgbd_files_in(folder).empty();
}

/// Removes what write_sequence writes and nothing else.
void clear_sequence(const fs::path& folder) {
  for (const std::string& name : text_files()) fs::remove(folder / name);
  for (const fs::path& file : rgbd_files_in(folder)) fs::remove(file);
  remove_rgbd_folders(folder);
  for (const std::string& name : image_folders()) {
    if (!fs::is_directory(folder / name)) continue;
    std::vector<fs::path> images;
    for (const auto& entry : fs::directory_iterator(folder / name))
      if (entry.is_regular_file() && entry.path().extension() == ".png") images.push_back(entry.path());
    for (const fs::path& image : images) fs::remove(image);
  }
}

void check_target(const fs::path& folder, bool force) {
  std::error_code none;
  if (fs::exists(folder, none) && !fs::is_directory(folder, none))
    throw InputError(
        fmt::format("{} is a file, expected a folder to write the sequence to", folder.string()));
  if (!force && holds_sequence(folder))
    throw InputError(fmt::format("{} holds a sequence already; give --force to replace it", folder.string()));
}

/// A folder by its whole name, links followed.
fs::path whole_name(const fs::path& folder) {
  std::error_code none;
  const fs::path whole = fs::weakly_canonical(fs::absolute(folder, none), none);
  return whole.filename().empty() ? whole.parent_path() : whole;
}

/// Where a sequence is written before it takes its folder: beside it, as FOLDER.part. The folder itself where
/// there is no room beside, above a mounted disk.
fs::path place_while_written(fs::path whole) {
  struct stat own {
  }, parent{};
  const bool is_there = ::stat(whole.c_str(), &own) == 0;
  if (is_there && (::stat(whole.parent_path().c_str(), &parent) != 0 || own.st_dev != parent.st_dev ||
                   ::access(whole.parent_path().c_str(), W_OK) != 0))
    return whole;
  return whole += ".part";
}

/// What lies in one folder goes into another, but for what is there already.
void move_into(const fs::path& from, const fs::path& to) {
  std::error_code none;
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(from, none)) entries.push_back(entry.path());
  for (const fs::path& entry : entries) {
    const fs::path target = to / entry.filename();
    if (!fs::exists(target, none))
      fs::rename(entry, target, none);
    else if (fs::is_directory(entry, none) && fs::is_directory(target, none))
      move_into(entry, target);
  }
  fs::remove(from, none);
}

/// What was written takes its folder; what others put there stays there.
void take_place(const fs::path& written, const fs::path& folder) {
  std::error_code failed;
  if (fs::equivalent(written, folder, failed)) return;
  fs::rename(written, folder, failed);  // onto nothing, or an empty folder
  if (!failed) return;
  // Both change places in one step, so that the earlier sequence or this one is there, whatever ends the
  // program.
  if (::renameat2(AT_FDCWD, written.c_str(), AT_FDCWD, folder.c_str(), RENAME_EXCHANGE) != 0)
    throw InputError(fmt::format("{} cannot be written to: {}", folder.string(), std::strerror(errno)));
  clear_sequence(written);
  move_into(written, folder);
}

void prepare(const FrameSource& source, const fs::path& folder, const WriteOptions& options) {
  try {
    if (fs::exists(folder)) clear_sequence(folder);
    if (options.rgbd != nullptr) {
      make_rgbd_folders(*options.rgbd, folder);
    } else if (options.layout == SequenceLayout::tum) {
      fs::create_directories(folder / "rgb");
      if (source.has_depth()) fs::create_directories(folder / "depth");
    } else {
      const StereoNames names = stereo_names(source, 0, options.layout);
      for (const fs::path& image : {names.left, names.right})
        fs::create_directories(folder / image.parent_path());
    }
    if (source.has_masks()) fs::create_directories(folder / "mask");
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("{} cannot be written to: {}", folder.string(), error.code().message()));
  }
}

std::string image_name(double stamp) { return fmt::format("{:.6f}.png", stamp); }

struct WrittenFrame {
  bool readable = false;
  std::optional<double> depth_stamp;  // s, when the depth image was taken; nothing where there is none
  int too_far = 0;                    // pixels
};

void write_pair(const FrameSource& source, const Frame& frame, const fs::path& folder,
                SequenceLayout layout) {
  const StereoNames names = stereo_names(source, frame.index, layout);
  const bool gray = frame.colour.empty() || layout == SequenceLayout::euroc;
  if (frame.readable()) write_png(folder / names.left, gray ? frame.gray : frame.colour);
  if (frame.stereo)
    write_png(folder / names.right, gray ? to_gray(frame.stereo->right) : frame.stereo->right);
}

WrittenFrame write_frame(const FrameSource& source, int index, const fs::path& folder,
                         const WriteOptions& options) {
  const Frame frame = source.read(index);
  WrittenFrame written{.readable = frame.readable(), .depth_stamp = {}, .too_far = 0};
  const std::string name = image_name(source.timestamp(index));
  if (source.has_masks())
    if (const FrameTruth truth = source.truth(index); !truth.moving.empty())
      write_png(folder / "mask" / name, truth.moving);
  if (options.rgbd != nullptr) {
    written.too_far = write_rgbd_frame(*options.rgbd, source, frame, folder);
    return written;
  }
  if (options.layout != SequenceLayout::tum) {
    write_pair(source, frame, folder, options.layout);
    return written;
  }
  if (frame.readable()) write_png(folder / "rgb" / name, frame.colour.empty() ? frame.gray : frame.colour);
  if (!frame.has_depth()) return written;
  const StoredDepth stored = stored_depth(frame.depth, source.camera().depth_scale);
  write_png(folder / "depth" / image_name(frame.depth_timestamp), stored.image);
  written.too_far = stored.too_far;
  written.depth_stamp = frame.depth_timestamp;
  return written;
}

/// All frames, by as many threads as wanted; the first failure ends them and is thrown.
/// @returns those that were written: from the first one on
std::vector<WrittenFrame> write_frames(const FrameSource& source, const fs::path& folder,
                                       const WriteOptions& options) {
  std::atomic<int> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;  // of done and failure
  int done = 0;
  std::exception_ptr failure;
  std::vector<WrittenFrame> written(static_cast<std::size_t>(source.size()));
  const auto work = [&] {
    // Whoever has taken a frame writes it, so that none is missing before the last.
    while (!failed && !(options.stop != nullptr && *options.stop)) {
      const int i = next++;
      if (i >= source.size()) break;
      try {
        written[static_cast<std::size_t>(i)] = write_frame(source, i, folder, options);
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
  written.resize(static_cast<std::size_t>(done));
  return written;
}

/// Names the depth image of a frame that has none: one that is not there, and is no other frame's.
std::string no_depth_name(int index) { return fmt::format("none_{:06}.png", index); }

void write_list(const FrameSource& source, const fs::path& folder, const char* name,
                const std::vector<std::optional<double>>& stamps) {
  std::string text = fmt::format("# {} images of {}\n# timestamp filename\n", name, source.name());
  for (const std::optional<double>& stamp : stamps)
    if (stamp) text += fmt::format("{:.6f} {}/{}\n", *stamp, name, image_name(*stamp));
  write_text_file(folder / (std::string(name) + ".txt"), text);
}

/// Masks of a layout that has stamps of its own.
void write_mask_list(const FrameSource& source, const fs::path& folder,
                     const std::vector<std::optional<double>>& stamps, const RgbdLayout& layout) {
  std::string text = "# timestamp filename\n";
  for (std::size_t i = 0; i < stamps.size(); ++i)
    if (stamps[i])
      text +=
          fmt::format("{:.6f} mask/{}\n",
                      layout.files.names(static_cast<int>(i), source.timestamp(static_cast<int>(i))).stamp,
                      image_name(*stamps[i]));
  write_text_file(folder / "mask.txt", text);
}

/// A pair a frame, whether or not its images are there: readers that go by pairs count frames by them.
void write_pairs(const FrameSource& source, const fs::path& folder,
                 const std::vector<WrittenFrame>& written) {
  std::string pairs;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const int index = static_cast<int>(i);
    const double stamp = source.timestamp(index);
    const auto& depth = written[i].depth_stamp;
    pairs += fmt::format("{0:.6f} rgb/{1} {2:.6f} depth/{3}\n", stamp, image_name(stamp),
                         depth.value_or(stamp), depth ? image_name(*depth) : no_depth_name(index));
  }
  write_text_file(folder / "associations.txt", pairs);
}

void write_lists(const FrameSource& source, const fs::path& folder, const std::vector<WrittenFrame>& written,
                 const WriteOptions& options) {
  std::vector<std::optional<double>> colours, depths, masks;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const double stamp = source.timestamp(static_cast<int>(i));
    colours.emplace_back(stamp);
    depths.push_back(written[i].depth_stamp);
    masks.push_back(fs::exists(folder / "mask" / image_name(stamp)) ? std::optional(stamp) : std::nullopt);
  }
  const SequenceLayout layout = options.layout;
  if (options.rgbd != nullptr) {
    options.rgbd->files.write_texts({source, folder, static_cast<int>(written.size())});
    if (source.has_masks()) write_mask_list(source, folder, masks, *options.rgbd);
    return;
  }
  if (layout == SequenceLayout::tum || layout == SequenceLayout::left_right) {
    write_text_file(folder / "camera.toml", camera_text(registered_camera(source)));
    if (!source.ground_truth().empty())
      write_tum_trajectory((folder / "groundtruth.txt").string(), source.ground_truth());
  }
  if (source.has_masks()) write_list(source, folder, "mask", masks);
  if (layout != SequenceLayout::tum) {
    write_stereo_texts(source, folder, static_cast<int>(written.size()), layout);
    return;
  }
  if (source.has_depth()) {
    write_list(source, folder, "depth", depths);
    write_pairs(source, folder, written);
  }
  write_list(source, folder, "rgb", colours);
}

/// The layout asked for, or the source's own.
SequenceLayout layout_of(const FrameSource& source, const WriteOptions& options) {
  const bool is_stereo = source.camera().is_stereo();
  const SequenceLayout asked = options.rgbd != nullptr ? SequenceLayout::tum : options.layout;
  if (asked == SequenceLayout::own) return is_stereo ? SequenceLayout::left_right : SequenceLayout::tum;
  if (is_stereo == (asked == SequenceLayout::tum))
    throw InputError(fmt::format("{}: is {}, and cannot be written in a layout of {}", source.name(),
                                 is_stereo ? "stereo" : "RGB-D", is_stereo ? "RGB-D" : "stereo pairs"));
  return asked;
}

}  // namespace

Camera registered_camera(const FrameSource& source) {
  Camera camera = source.camera();
  camera.depth_camera.reset();
  return camera;
}

std::string camera_text(const Camera& c) {
  std::string text = fmt::format(
      "name = \"{}\"\nwidth = {}\nheight = {}\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n"
      "k1 = {}\nk2 = {}\np1 = {}\np2 = {}\nk3 = {}\ndepth_scale = {}\nreadout_s = {}\n",
      c.name, c.width, c.height, c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3, c.depth_scale,
      c.readout_s);
  if (c.depth_readout_s) text += fmt::format("depth_readout_s = {}\n", *c.depth_readout_s);
  if (c.depth_delay_s != 0.0) text += fmt::format("depth_delay_s = {}\n", c.depth_delay_s);
  if (c.is_stereo()) text += fmt::format("baseline_m = {}\n", c.baseline_m);
  if (!c.depth_camera) return text;
  const Camera& d = c.depth_camera->camera;
  text += fmt::format(
      "\n[depth_camera]\nwidth = {}\nheight = {}\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n"
      "k1 = {}\nk2 = {}\np1 = {}\np2 = {}\nk3 = {}\ncolour_from_depth = [\n",
      d.width, d.height, d.fx, d.fy, d.cx, d.cy, d.k1, d.k2, d.p1, d.p2, d.k3);
  const Eigen::Matrix4d m = c.depth_camera->colour_from_depth.matrix();
  for (int row = 0; row < 3; ++row)
    text += fmt::format("  [{}, {}, {}, {}],\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
  return text + "]\n";
}

void remove_sequence(const fs::path& folder) {
  std::error_code ignored;  // what others put there meanwhile stays, and the folder with it
  clear_sequence(folder);
  for (const std::string& name : image_folders()) fs::remove(folder / name, ignored);
  for (const char* name : {"mav0/cam0", "mav0/cam1", "mav0/state_groundtruth_estimate0", "mav0"})
    fs::remove(folder / name, ignored);
  fs::remove(folder, ignored);
}

WrittenSequence write_sequence(const FrameSource& source, const fs::path& folder,
                               const WriteOptions& options) {
  if (source.size() == 0) throw InputError(fmt::format("{} has no frames to write", source.name()));
  WriteOptions own = options;
  own.layout = layout_of(source, options);
  check_target(folder, options.force);
  const fs::path whole = whole_name(folder), place = place_while_written(whole);
  try {
    prepare(source, place, own);
    const std::vector<WrittenFrame> frames = write_frames(source, place, own);
    WrittenSequence written{
        .frames = static_cast<int>(frames.size()),
        .unreadable = {},
        .too_far = 0,
        .depth_units = own.rgbd != nullptr ? own.rgbd->files.units : source.camera().depth_scale};
    for (int i = 0; i < written.frames; ++i) {
      if (!frames[static_cast<std::size_t>(i)].readable) written.unreadable.push_back(i);
      written.too_far += frames[static_cast<std::size_t>(i)].too_far;
    }
    if (frames.empty()) {
      remove_sequence(place);
      return written;
    }
    if (written.unreadable.size() == frames.size())
      throw InputError(
          fmt::format("{}: none of the {} frames to write can be read", source.name(), frames.size()));
    write_lists(source, place, frames, own);
    take_place(place, whole);
    return written;
  } catch (...) {
    try {
      remove_sequence(place);
    } catch (
        const fs::filesystem_error&) {  // what cannot be taken away stays; the first fault is the one to tell
    }
    throw;
  }
}

}  // namespace stillpoint
