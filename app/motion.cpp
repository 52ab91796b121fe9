#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/motion_colour.hpp"
#include "app/motion_figures.hpp"
#include "app/motion_pictures.hpp"
#include "app/progress.hpp"
#include "core/config.hpp"
#include "core/error.hpp"
#include "core/motion/epipolar/colour_motion.hpp"
#include "core/motion/paper/detect_motion.hpp"
#include "core/out_folder.hpp"
#include "core/sequence/image_file.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct MotionOptions {
  std::string first;   ///< the previous image, or a sequence
  std::string second;  ///< the next image; empty for a sequence
  std::string out;
  ConfigArguments config;
  std::string frames;  ///< A:B:STEP
  std::string method = "paper";
  bool all_rounds = false;
  bool force = false;
};

/// Frames of a sequence, first to end (exclusive) by step.
struct FrameRange {
  int begin = 0, end = 0, step = 1;
};

FrameRange parse_range(const std::string& text, int size) {
  FrameRange range{0, size, 1};
  if (text.empty()) return range;
  const auto wrong = [&text] {
    return InputError(
        fmt::format("--frames {}: expected A:B:STEP, whole numbers with 0 <= A < B and STEP >= 1; each "
                    "may be left out",
                    text));
  };
  std::vector<std::string> parts(1);
  for (const char letter : text) {
    if (letter == ':') {
      parts.emplace_back();
    } else if (std::isdigit(static_cast<unsigned char>(letter)) != 0 && parts.back().size() < 9) {
      parts.back() += letter;
    } else {
      throw wrong();
    }
  }
  if (parts.size() > 3) throw wrong();
  if (!parts[0].empty()) range.begin = std::stoi(parts[0]);
  if (parts.size() == 1) range.end = range.begin + 1;
  if (parts.size() > 1 && !parts[1].empty()) range.end = std::min(size, std::stoi(parts[1]));
  if (parts.size() > 2 && !parts[2].empty()) range.step = std::stoi(parts[2]);
  if (range.step < 1 || range.begin >= range.end)
    throw InputError(fmt::format("--frames {}: names none of the {} frames there are", text, size));
  return range;
}

/// Whether all of `text` from `first` on is digits, at least one.
bool is_number_from(const std::string& text, std::size_t first) {
  return text.size() > first && std::all_of(text.begin() + static_cast<std::ptrdiff_t>(first), text.end(),
                                            [](unsigned char letter) { return std::isdigit(letter) != 0; });
}

/// Removes an earlier result's pictures, those of each pair and of each round, and the folders that are empty
/// then.
void clear_earlier(const fs::path& folder) {
  remove_round_pictures(folder);
  remove_colour_motion_pictures(folder);
  std::vector<fs::path> below;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() &&
        (is_number_from(name, 0) || (name.starts_with("round_") && is_number_from(name, 6))))
      below.push_back(entry.path());
  }
  for (const fs::path& one : below) {
    clear_earlier(one);
    fs::remove(one, ignored);  // which leaves a folder that is not empty
  }
}

/// The out folder with its two lists; pictures go beside them.
class MotionOutput {
 public:
  MotionOutput(const fs::path& folder, bool force, bool all_rounds)
      : folder_(folder), all_rounds_(all_rounds), pairs_(nlohmann::json::array()) {
    prepare_out_folder(folder, {"motion.csv", "motion.json"}, force);
    if (fs::exists(folder / "motion.csv")) clear_earlier(folder);
    csv_.open(folder / "motion.csv");
    csv_ << motion_csv_heading() << '\n' << std::flush;
    if (!csv_) throw InputError(fmt::format("{}: cannot be written", (folder / "motion.csv").string()));
  }

  /// @param subfolder of the pair's pictures; empty = the out folder itself
  void add(const std::string& subfolder, const std::string& reference_name, const std::string& target_name,
           const PaperTrace& trace, const cv::Mat& reference, const cv::Mat& target) {
    const fs::path folder = folder_ / subfolder;
    prepare_out_folder(folder, {}, true);
    if (all_rounds_) {
      for (std::size_t i = 0; i < trace.rounds.size(); ++i) {
        const fs::path round_folder = folder / fmt::format("round_{}", i + 1);
        prepare_out_folder(round_folder, {}, true);
        write_round_pictures(round_folder, trace.rounds[i], reference, target);
      }
    } else if (!trace.rounds.empty()) {
      write_round_pictures(folder, trace.rounds.back(), reference, target);
    }
    add_figures(reference_name, target_name, trace);
  }

  /// A pair's figures alone.
  void add_figures(const std::string& reference_name, const std::string& target_name,
                   const PaperTrace& trace) {
    csv_ << motion_csv_row(reference_name, target_name, trace) << '\n' << std::flush;
    if (!csv_) throw InputError(fmt::format("{}: cannot be written", (folder_ / "motion.csv").string()));
    pairs_.push_back(motion_json(reference_name, target_name, trace));
  }

  void finish(const Config& config) {
    const nlohmann::json figures = {{"reference_gap", config.motion.reference_gap}, {"pairs", pairs_}};
    write_text_file(folder_ / "motion.json", figures.dump(1) + '\n');
    write_text_file(folder_ / "config.toml", to_toml(config));
  }

 private:
  fs::path folder_;
  bool all_rounds_;
  std::ofstream csv_;
  nlohmann::json pairs_;
};

void print_pair(const std::string& reference, const std::string& target, const PaperTrace& trace) {
  std::string line = fmt::format("{} -> {}: ", reference, target);
  if (!trace.mask().empty())
    line += fmt::format("{:.1f} % moves, {} regions, {} rounds", 100.0 * trace.rounds.back().mask_share,
                        trace.rounds.back().regions.size(), trace.rounds.size());
  if (!trace.note.empty()) line += (trace.mask().empty() ? "" : "; ") + trace.note;
  std::printf("%s\n", line.c_str());
}

cv::Mat to_colour(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat colour;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

cv::Mat read_whole_image(const std::string& path) {
  const ImageRead read = read_image(path);
  if (read.image.empty()) throw InputError(read.problem);
  return to_8bit(read.image);
}

void run_pair(const MotionOptions& options, const Config& config) {
  if (!options.frames.empty())
    throw InputError("--frames chooses among a sequence's frames, and two images were given");
  const cv::Mat reference = read_whole_image(options.first), target = read_whole_image(options.second);
  if (reference.size() != target.size())
    throw InputError(fmt::format("{} is {}x{} and {} is {}x{}: the two images must be of one size",
                                 options.first, reference.cols, reference.rows, options.second, target.cols,
                                 target.rows));
  const PaperTrace trace =
      detect_motion(to_gray(reference), to_gray(target), config.motion, config.run.threads);
  MotionOutput output(options.out, options.force, options.all_rounds);
  output.add("", options.first, options.second, trace, to_colour(reference), to_colour(target));
  output.finish(config);
  print_pair(options.first, options.second, trace);
}

cv::Mat picture_of(const Frame& frame) { return to_colour(frame.colour.empty() ? frame.gray : frame.colour); }

/// What is wrong with a pair of frames before motion detection sees them; empty when all is well.
std::string problem_of(const Frame& reference, const Frame& target) {
  for (const Frame* frame : {&reference, &target})
    if (!frame->readable()) return "no mask: " + frame->problem;
  if (reference.gray.size() != target.gray.size())
    return fmt::format("no mask: frame {} is {}x{} and frame {} is {}x{}", reference.index,
                       reference.gray.cols, reference.gray.rows, target.index, target.gray.cols,
                       target.gray.rows);
  return {};
}

void run_sequence(const MotionOptions& options, const Config& config) {
  // Its warnings are about cameras and times, which images alone do without.
  OpenOptions open;
  open.seed = static_cast<unsigned>(config.run.seed);
  const std::unique_ptr<FrameSource> source = open_sequence(options.first, open);
  const int gap = config.motion.reference_gap;
  FrameRange range = parse_range(options.frames, source->size());
  while (range.begin < gap && range.begin < range.end) range.begin += range.step;
  if (range.begin >= range.end)
    throw InputError(fmt::format("{}: of its {} frames none of those chosen has a reference {} frames back",
                                 options.first, source->size(), gap));
  MotionOutput output(options.out, options.force, options.all_rounds);
  int pairs = 0, without_mask = 0;
  for (int index = range.begin; index < range.end && !stop_requested(); index += range.step) {
    const Frame reference = source->read(index - gap), target = source->read(index);
    const std::string reference_name = std::to_string(index - gap), target_name = std::to_string(index);
    PaperTrace trace;
    trace.note = problem_of(reference, target);
    if (trace.note.empty()) {
      trace = detect_motion(reference.gray, target.gray, config.motion, config.run.threads);
      output.add(fmt::format("{:06d}", index), reference_name, target_name, trace, picture_of(reference),
                 picture_of(target));
    } else {
      output.add_figures(reference_name, target_name, trace);
    }
    print_pair(reference_name, target_name, trace);
    ++pairs;
    if (trace.mask().empty()) ++without_mask;
  }
  output.finish(config);
  std::printf("%d pairs, %d of them without a mask; figures in %s\n", pairs, without_mask,
              (fs::path(options.out) / "motion.csv").c_str());
  throw_if_interrupted();
}

/// Method `stillpoint`: judged over several frames, so all from the first on are seen, and those chosen
/// written.
void run_colour_sequence(const MotionOptions& options, const Config& config) {
  OpenOptions open;
  open.seed = static_cast<unsigned>(config.run.seed);
  const std::unique_ptr<FrameSource> source = open_sequence(options.first, open);
  const FrameRange range = parse_range(options.frames, source->size());
  const fs::path folder = options.out;
  prepare_out_folder(folder, {"motion.csv", "motion.json"}, options.force);
  if (fs::exists(folder / "motion.csv")) clear_earlier(folder);
  std::string rows = colour_motion_csv_heading() + '\n';
  nlohmann::json frames = nlohmann::json::array();
  ColourMotionDetector detector(source->camera(), config.colour_motion);
  for (int index = 0; index < range.end && !stop_requested(); ++index) {
    const Frame frame = source->read(index);
    EpipolarTrace trace;
    if (frame.readable())
      trace = detector.next(frame.colour.empty() ? frame.gray : frame.colour, frame.timestamp);
    else
      trace.note = "no mask: " + frame.problem;
    if (index < range.begin || (index - range.begin) % range.step != 0) continue;
    rows += colour_motion_csv_row(index, trace, config.colour_motion) + '\n';
    frames.push_back(colour_motion_json(index, trace, config.colour_motion));
    if (frame.readable()) {
      const fs::path pictures = folder / fmt::format("{:06d}", index);
      prepare_out_folder(pictures, {}, true);
      write_colour_motion_pictures(pictures, trace, picture_of(frame), config.colour_motion);
    }
    std::printf("%d: %.1f %% moves, %zu regions%s%s\n", index, 100.0 * trace.mask_share, trace.regions.size(),
                trace.note.empty() ? "" : "; ", trace.note.c_str());
  }
  write_text_file(folder / "motion.csv", rows);
  write_text_file(folder / "motion.json",
                  nlohmann::json{{"method", "stillpoint"}, {"frames", frames}}.dump(1) + '\n');
  write_text_file(folder / "config.toml", to_toml(config));
  std::printf("%zu frames; figures in %s\n", frames.size(), (folder / "motion.csv").c_str());
  throw_if_interrupted();
}

}  // namespace

void add_motion_command(CLI::App& app) {
  auto options = std::make_shared<MotionOptions>();
  CLI::App* command = app.add_subcommand(
      "motion",
      "What moves between two images, or along a folder of colour frames: masks, differences and figures");
  command
      ->add_option("first", options->first, "The previous image; or a sequence, when no next image is given")
      ->required();
  command->add_option("next", options->second, "The next image, of the same size");
  command->add_option("--out", options->out, "Folder for the results, made if missing")->required();
  options->config.add_to(*command, false);
  command->add_option(
      "--frames", options->frames,
      "Target frames A:B:STEP of a sequence, B not among them; references lie motion.reference_gap "
      "frames back");
  command
      ->add_option(
          "--method", options->method,
          "paper: a pair of frames after the other; stillpoint: from colour over tenths of a second, "
          "for sequences")
      ->check(CLI::IsMember({"paper", "stillpoint"}))
      ->capture_default_str();
  command->add_flag("--all-rounds", options->all_rounds, "Pictures of every round, not of the last alone");
  command->add_flag("--force", options->force, "Overwrite earlier results");
  command->callback([options] {
    const Config config = options->config.config();
    if (options->method == "stillpoint") {
      if (!options->second.empty())
        throw InputError("--method stillpoint follows points over several frames: give it a sequence");
      run_colour_sequence(*options, config);
    } else if (options->second.empty()) {
      run_sequence(*options, config);
    } else {
      run_pair(*options, config);
    }
  });
}

}  // namespace stillpoint
