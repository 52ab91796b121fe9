#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/sequence/frame.hpp"
#include "core/sequence/image_survey.hpp"

namespace stillpoint {

// Masks that somebody else made, an image a frame: which file belongs to a frame, and what it says.

/// How the values of mask images are read.
struct MaskReading {
  /// What is dynamic: values of a label image, "#rrggbb" of a coloured one; empty: white, or whatever is not
  /// 0 where the masks hold 0 and 1 or labels.
  std::vector<std::string> labels;
  bool inverted = false;  ///< what that says is static, and the rest dynamic
  int first_number = -1;  ///< the number of the first frame's mask; below 0: 1 where there is no 0, else 0
};

/// A frame's mask of one source.
struct FoundMask {
  cv::Mat mask;         ///< CV_8UC1, 255 = dynamic, the frame's size; empty where there is none
  std::string problem;  ///< why, a few words with the file's name; empty when all is well
};

/// A folder of mask images, or a list of them (`stamp file` a line, relative to the list). A folder that
/// holds no images but a list, or a folder of masks, stands for that.
///
/// A file belongs to the frame whose colour image has its name, or a name within it ("000012_mask"); else to
/// the one nearest in time, where names are stamps; else to the one of its number. Several files of one frame
/// (an image an instance) are united. Reading is const and safe from several threads at once.
class MaskFiles {
 public:
  /// @throws InputError in one sentence where there is no such folder or list, or no image in it
  MaskFiles(const std::string& where, const MaskReading& reading);

  /// Never throws for what is wrong with a file.
  [[nodiscard]] FoundMask read(const Frame& frame) const;

  [[nodiscard]] const std::string& where() const { return where_; }
  /// What its files are named by, some words: "its 40 files are of 5.000 s to 6.300 s".
  [[nodiscard]] std::string naming() const;
  /// How the images were understood, where that could be doubted, one sentence each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  using Files = std::vector<std::string>;

  void read_list_file(const std::string& path);
  void read_folder(const std::string& folder);
  void settle_numbers();
  void survey();
  [[nodiscard]] const Files* files_of(const Frame& frame) const;
  [[nodiscard]] const Files* files_named(const std::string& name) const;
  [[nodiscard]] const Files* files_at(double number, double tolerance) const;
  [[nodiscard]] cv::Mat decode(const cv::Mat& image, std::string& problem) const;

  std::string where_;
  MaskReading reading_;
  std::map<std::string, Files> by_name_;   // a file's name without its end
  std::map<std::string, Files> by_token_;  // the part of that name which numbers it, as written
  std::map<double, Files> by_number_;      // s where stamps_, otherwise frame numbers
  bool stamps_ = false;
  double first_number_ = 0.0;
  MaskCoding coding_ = MaskCoding::bright;
  std::vector<std::string> warnings_;
};

}  // namespace stillpoint
