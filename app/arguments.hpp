#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/check/check_sequence.hpp"
#include "core/config.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// What an option with a number takes: from `least` to `most`, and no "nan", which CLI::Range lets pass.
[[nodiscard]] CLI::Validator number_between(double least, double most);

/// The options that every command which runs a method shares: where its constants come from.
struct ConfigArguments {
  std::string preset;                    ///< a preset's name or a TOML file; empty = defaults
  std::vector<std::string> assignments;  ///< `section.name=value`
  std::string method;                    ///< empty = the config's
  std::string odometry;                  ///< empty = the config's
  std::string masks;                     ///< folders and lists, parted by commas; empty = the config's
  int threads = 0;                       ///< 0 = the config's

  void add_to(CLI::App& command, bool with_method);
  /// Whether any was given but the number of threads.
  [[nodiscard]] bool given() const {
    return !preset.empty() || !assignments.empty() || !method.empty() || !odometry.empty() || !masks.empty();
  }
  /// @throws InputError for unknown presets, keys and values out of range.
  [[nodiscard]] Config config() const;
};

/// Refuses a command line whose options do not go together: one sentence, and status 2 as for an option that
/// is missing, unknown or out of range. What an option names, a file or a method, is refused by InputError.
[[noreturn]] void throw_usage(const std::string& what);

/// Results are kept apart from the data they are of. @param out empty = none are written
/// @throws InputError where it is the folder of one of the sequences
void throw_if_among_data(const std::string& out, const std::vector<std::string>& sequences);

/// @throws InputError where a sequence is to be written into a finished run's folder
void throw_if_among_results(const std::string& out);

/// @throws InputError where the config's method cannot stand in front of its odometry, or lacks masks
void throw_if_no_pair(const Config& config);

/// What a command cannot do without.
struct SequenceNeeds {
  bool depth = false;       ///< odometry
  bool oracle = false;      ///< ground-truth masks
  bool questioned = false;  ///< it is about to be run: what a quick look finds wrong with it is told
};

/// What SEQUENCE may be, for the help of commands that take one, several, or also a finished run.
inline constexpr const char* kSequenceHelp =
    "A folder (TUM RGB-D, Bonn, ICL-NUIM, 7-Scenes, Replica, ScanNet, OpenLORIS, ETH3D, Redwood, Open3D; "
    "stereo as KITTI odometry, EuRoC, TartanAir or left/ and right/), an archive of one (.tgz, .tar, .zip, "
    "…), a bag (.bag, .mcap, .db3), generated:KIND, or generated:KIND:stereo";
inline constexpr const char* kSequencesHelp =
    "Folders (TUM RGB-D, Bonn, ICL-NUIM, 7-Scenes, Replica, ScanNet, OpenLORIS, ETH3D, Redwood, Open3D; "
    "stereo as KITTI odometry, EuRoC, TartanAir or left/ and right/), archives of them (.tgz, .tar, .zip, "
    "…), bags (.bag, .mcap, .db3), generated:KIND, generated:KIND:stereo, or generated:all";
inline constexpr const char* kSequenceOrRunHelp =
    "A folder (TUM RGB-D, Bonn, ICL-NUIM, 7-Scenes, Replica, ScanNet, OpenLORIS, ETH3D, Redwood, Open3D; "
    "stereo as KITTI odometry, EuRoC, TartanAir or left/ and right/; colour frames), an archive of one "
    "(.tgz, .tar, .zip, …), a bag (.bag, .mcap, .db3), a video (.mp4, .mkv, .avi), generated:KIND, "
    "generated:KIND:stereo, "
    "or a finished run's folder";

/// The options that say which frames, and how they are to be read.
struct SequenceArguments {
  std::string camera;        ///< NAME|FILE; empty = the folder tells
  int frames = 0;            ///< 0 = all
  int seed = -1;             ///< of generated sequences; negative = the config's
  double frame_rate = 0.0;   ///< Hz, of stamps that are frame numbers; 0 = 30
  double depth_scale = 0.0;  ///< units a metre; 0 = the camera's
  double depth_offset_s = 0.0;
  std::string truth;  ///< a PoseConvention's name; empty = as written
  bool inverted_masks = false;
  std::string topics;           ///< of a bag, as OpenOptions has them; empty = as they are found
  bool calibrate_time = false;  ///< measure the camera's times first, and use them
  bool fix = false;             ///< question the sequence first, and read it as is certain to be right
  std::string stereo;           ///< of stereo pairs, as stereo_options_from reads it; empty = as a rule

  /// @param frames_option what sets `frames`, where --frames means something else
  void add_to(CLI::App& command, const char* frames_option = "--frames");
  /// Whether any was given.
  [[nodiscard]] bool given() const;
  /// What was given, "camera=freiburg1", …, to be kept and given again. Paths are made absolute.
  [[nodiscard]] std::vector<std::string> words() const;
  /// @param words those that are none are passed over
  [[nodiscard]] static SequenceArguments from_words(const std::vector<std::string>& words);
  /// What open_sequence is given.
  /// @throws InputError for a camera or a convention that is none
  [[nodiscard]] OpenOptions options(const Config& config) const;
  /// Reads it by that switch from now on.
  void set(const Remedy& remedy);
  /// With `fix`: the sequence is questioned (check_sequence), and these are the arguments under which no
  /// certain remedy is left, each told on standard error; what was given stands. Without: these.
  /// @throws InputError for a finished run's folder
  [[nodiscard]] SequenceArguments fixed(const std::string& where, const Config& config) const;
  /// Opens a folder or `generated:KIND`, and tells its warnings on standard error.
  /// @throws InputError also where it lacks what is needed, with the reason
  [[nodiscard]] std::unique_ptr<FrameSource> open(const std::string& where, const Config& config,
                                                  SequenceNeeds needs = {}) const;

 private:
  /// Options that this kind of sequence would pass over in silence.
  void tell_what_is_of_no_use(const std::string& where, const FrameSource& source) const;
};

/// A convention by its name; empty = as written.
/// @throws InputError naming the option and all conventions
[[nodiscard]] PoseConvention convention_argument(const char* option, const std::string& name);

/// The sequences named, with every kind in place of `generated:all`.
[[nodiscard]] std::vector<std::string> expanded_sequences(const std::vector<std::string>& sequences);

}  // namespace stillpoint
