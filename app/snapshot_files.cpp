#include "app/snapshot_files.hpp"

#include <fmt/format.h>

#include <map>

#include "core/counted.hpp"

namespace stillpoint {

SnapshotFiles::SnapshotFiles(Wanted wanted, std::pair<int, int> size, double step_s)
    : wanted_(std::move(wanted)), folder_(wanted_.folder) {
  if (!wanted_.video.empty())
    video_.emplace(wanted_.video, cv::Size(size.first, size.second), wanted_.fps, step_s, wanted_.force);
  if (folder_.empty()) return;
  made_.emplace(folder_);
  prepare_out_folder(folder_, {"snapshots.txt"}, wanted_.force);
}

void SnapshotFiles::add(const SessionView& view, Painter& painter) {
  painter.paint(view, [&](const Painter::Picture& picture) {
    if (video_) video_->add(picture.image, view.current->frame.timestamp);
    if (folder_.empty()) return;
    const std::string frame = fmt::format("{:06d}_", view.current->index);
    writer_.write(folder_ / (frame + picture.name + ".png"), picture.image);
    ++files_;
    write_plots(frame, picture);
  });
  list_ += fmt::format("{:06d} {:.6f} {}\n", view.current->index, view.current->frame.timestamp,
                       to_string(view.current->record->status));
  ++frames_;
}

/// A picture's plots and tables by its name and their own, in those kinds of file that each can be.
void SnapshotFiles::write_plots(const std::string& frame, const Painter::Picture& picture) {
  std::map<std::string, int> taken;  // how often a name was met in this picture
  for (const FileOffer& offer : picture.offers) {
    std::string name = std::filesystem::path(offer.name).stem().string();
    if ((name + '_').rfind(picture.name + '_', 0) != 0) name = picture.name + '_' + name;
    if (const int before = taken[name]++; before > 0) name += fmt::format("_{}", before + 1);
    for (const std::string& kind : wanted_.plots) {
      if (offer.endings.find('.' + kind) == std::string::npos) continue;
      offer.write((folder_ / fmt::format("{}{}.{}", frame, name, kind)).string());
      ++plot_files_;
    }
  }
}

std::string SnapshotFiles::finish() {
  std::string told;
  writer_.finish();
  if (!folder_.empty()) {
    // What was drawn, and the sign that this folder is ours.
    write_text_file(folder_ / "snapshots.txt", "# frame, timestamp in s, status\n" + list_);
    const std::string plots =
        wanted_.plots.empty() ? ""
                              : fmt::format(", and {} of plots and tables,", counted(plot_files_, "file"));
    told = fmt::format("{}{} of {} written to {}\n", counted(files_, "image"), plots,
                       counted(frames_, "frame"), folder_.string());
  }
  if (video_ && frames_ > 0) {
    video_->finish();
    told += fmt::format("video of {} written to {}\n", counted(frames_, "frame"), wanted_.video);
  }
  return told;
}

}  // namespace stillpoint
