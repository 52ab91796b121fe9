#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/error.hpp"

namespace stillpoint {

/// A folder of its own that goes away with the object.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name = "sequence") {
    static std::atomic<int> count{0};
    root_ = std::filesystem::temp_directory_path() /
            ("stillpoint_" + std::to_string(::getpid()) + "_" + std::to_string(count++));
    folder_ = root_ / name;
    std::filesystem::create_directories(folder_);
  }
  ~TemporaryFolder() {
    std::error_code none;
    std::filesystem::remove_all(root_, none);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] std::string path(const std::string& file = "") const {
    return file.empty() ? folder_.string() : (folder_ / file).string();
  }
  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((folder_ / file).parent_path());
    std::ofstream(path(file), std::ios::binary) << text;
  }
  void write(const std::string& file, const cv::Mat& image) const {
    std::filesystem::create_directories((folder_ / file).parent_path());
    ASSERT_TRUE(cv::imwrite(path(file), image)) << file;
  }
  [[nodiscard]] std::string read(const std::string& file) const {
    std::ifstream stream(path(file), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  /// Leaves the first `share` of a file.
  void truncate(const std::string& file, double share) const {
    const auto size = static_cast<double>(std::filesystem::file_size(path(file)));
    std::filesystem::resize_file(path(file), static_cast<std::uintmax_t>(size * share));
  }

 private:
  std::filesystem::path root_, folder_;
};

/// The sentence of the InputError that `act` throws; a failure when it throws none.
template <typename Act>
std::string input_error_of(Act&& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return {};
}

}  // namespace stillpoint
