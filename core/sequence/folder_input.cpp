#include <fmt/format.h>

#include <utility>

#include "core/error.hpp"
#include "core/sequence/folder_camera.hpp"
#include "core/sequence/rgbd/rgbd_input.hpp"
#include "core/sequence/sequence_input.hpp"
#include "core/sequence/stereo/stereo_input.hpp"

namespace stillpoint {
namespace {

/// An archive that is cut off may lack what is missed.
InputError with_cause(const InputError& error, const std::string& cause) {
  return InputError(fmt::format("{} ({})", error.what(), cause));
}

class FolderInput final : public SequenceInput {
 public:
  FolderInput(std::unique_ptr<FileStore> files, const OpenOptions& options)
      : files_(std::move(files)), options_(options) {
    options_.progress = nullptr;  // of the opening alone
  }

  [[nodiscard]] std::string name() const override { return files_->own_names().front(); }
  [[nodiscard]] const std::string& place() const override { return files_->place(); }
  [[nodiscard]] FolderLists lists() override {
    try {
      return read_folder_lists(*files_, options_.frame_rate);
    } catch (const InputError& error) {
      if (files_->warnings().empty()) throw;
      throw with_cause(error, files_->warnings().front());
    }
  }
  [[nodiscard]] FolderTruth truth(const std::vector<double>& stamps, StampUnit unit) override {
    return read_folder_truth(*files_, stamps, unit, options_.frame_rate, options_.truth);
  }
  [[nodiscard]] Camera camera(std::vector<std::string>& warnings) override {
    return camera_of_folder(*files_, options_.camera, warnings);
  }
  [[nodiscard]] ImageRead image(const std::string& file) const override {
    Bytes bytes;
    const std::string path = path_of(file);
    const std::string fault = files_->read(file, bytes);
    return fault.empty() ? decode_image(path, std::move(bytes)) : ImageRead{{}, path + " " + fault};
  }
  [[nodiscard]] std::string why_no_bytes(const std::string& file) const override {
    return files_->why_no_bytes(file);
  }
  [[nodiscard]] std::string path_of(const std::string& file) const override { return files_->path_of(file); }
  [[nodiscard]] std::vector<std::string> warnings() const override { return files_->warnings(); }

 private:
  std::unique_ptr<FileStore> files_;
  OpenOptions options_;
};

}  // namespace

std::unique_ptr<SequenceInput> make_folder_input(std::unique_ptr<FileStore> files,
                                                 const OpenOptions& options) {
  const std::vector<std::string> told = files->warnings();
  try {
    if (!has_image_lists(*files))
      if (auto stereo = make_stereo_input(files, options)) return stereo;
    if (auto rgbd = make_rgbd_input(files, options)) return rgbd;
  } catch (const InputError& error) {
    throw told.empty() ? error : with_cause(error, told.front());
  }
  return std::make_unique<FolderInput>(std::move(files), options);
}

}  // namespace stillpoint
