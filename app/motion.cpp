#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/motion_output.hpp"
#include "app/progress.hpp"
#include "core/config.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/inspect/frame_ranges.hpp"
#include "core/inspect/motion_replay.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/motion_stage.hpp"
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
  std::string frames;  ///< as parse_frame_ranges has them; empty = all
  std::string method;  ///< empty = the first that keeps no state
  bool all_rounds = false;
  bool force = false;
};

/// Whether a method judges frames by their images alone: without poses, features and true masks.
bool judges_images(const MethodInfo& method) {
  const MotionNeeds& needs = method.needs;
  return !method.baseline && !needs.first_pose && !needs.matches && !needs.true_mask;
}

/// The method that judges here in the name of one: its stand-in for frames without depth, where it has one.
const MethodInfo& judging_method(const MethodInfo& method) {
  return method.without_depth.empty() ? method : method_named(method.without_depth);
}

/// The methods that can be named here, each with what there is to say of it.
std::vector<std::string> described_methods() {
  std::vector<std::string> all;
  for (const MethodInfo& named : methods()) {
    const MethodInfo& method = judging_method(named);
    if (!judges_images(method)) continue;
    if (&method != &named)
      all.push_back(fmt::format("{} (stands for {} here)", named.name, method.name));
    else
      all.push_back(named.name + (method.needs.keeps_state ? " (over several frames, for sequences)" : ""));
  }
  return all;
}

/// The method the user named, or the first that judges images and keeps no state.
const MethodInfo& method_named_by(const MotionOptions& options) {
  for (const MethodInfo& method : methods()) {
    const MethodInfo& judge = judging_method(method);
    if (!judges_images(judge)) continue;
    if (options.method.empty() ? !judge.needs.keeps_state : method.name == options.method) return method;
  }
  throw InputError(fmt::format("--method {} does not judge images alone; the methods that do are: {}",
                               options.method, fmt::join(described_methods(), "; ")));
}

void describe_stand_in(const MotionOptions& options, const MethodInfo& method) {
  if (!options.method.empty() && options.method != method.name)
    std::printf("method %s judges frames without depth by %s, which is what runs here\n",
                options.method.c_str(), method.name.c_str());
}

void print_frame(const JudgedFrame& frame) {
  std::string line = frame.reference.empty() ? frame.target + ": "
                                             : fmt::format("{} -> {}: ", frame.reference, frame.target);
  const MotionResult& result = frame.result;
  const bool judged = !result.mask.empty();
  if (judged)
    line += fmt::format("{:.1f} % dynamic, {}", 100.0 * result.mask_share,
                        counted(frame.regions.size(), "region"));
  if (judged && result.rounds > 0) line += ", " + counted(result.rounds, "round");
  if (!frame.note().empty()) line += (judged ? "; " : "") + frame.note();
  if (!judged && frame.note().empty()) line += "no mask";
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

Frame frame_of_image(const cv::Mat& image, int index) {
  Frame frame;
  frame.index = index;
  frame.timestamp = index / 30.0;  // s; nothing tells when it was taken
  if (image.channels() == 3) frame.colour = image;
  frame.gray = to_gray(image);
  return frame;
}

cv::Mat picture_of(const Frame& frame) { return to_colour(frame.colour.empty() ? frame.gray : frame.colour); }

void judge_frame(const Frame& frame, MotionReplay& replay, JudgedFrame& judged) {
  judged.result = replay.repeat(frame, nullptr).motion;
  judged.log = replay.describe(frame, judged.result);
  if (!judged.result.mask.empty()) judged.regions = find_regions(judged.result.mask).regions;
  judged.picture = picture_of(frame);
}

void run_pair(const MotionOptions& options, const Config& config, const MethodInfo& method) {
  if (method.needs.keeps_state)
    throw InputError(fmt::format(
        "--method {} follows what is dynamic over several frames: give it a sequence", options.method));
  if (method.needs.depth)
    throw InputError(fmt::format("--method {} needs depth: give it a sequence that has it", method.name));
  if (!options.frames.empty())
    throw_usage("--frames chooses among a sequence's frames, and two images were given");
  const cv::Mat reference = read_whole_image(options.first), target = read_whole_image(options.second);
  if (reference.size() != target.size())
    throw InputError(fmt::format("{} is {}x{} and {} is {}x{}: the two images must be of one size",
                                 options.first, reference.cols, reference.rows, options.second, target.cols,
                                 target.rows));
  const Camera camera = Camera().scaled_to(target.cols, target.rows);
  MotionReplay replay(camera, config);
  (void)replay.repeat(frame_of_image(reference, 0), nullptr);
  const Frame frame = frame_of_image(target, 1);
  JudgedFrame judged{options.first, options.second};
  judge_frame(frame, replay, judged);
  MotionOutput output(options.out, options.force, options.all_rounds, method,
                      MotionStage(camera, config).frames_back());
  describe_stand_in(options, method);
  output.add(judged);
  output.finish(config);
  print_frame(judged);
}

/// Judges frames of a sequence, in ascending order.
class SequenceJudge {
 public:
  SequenceJudge(const FrameSource& source, const Config& config)
      : source_(source),
        config_(config),
        frames_back_(MotionStage(source.camera(), config).frames_back()),
        frames_prepared_back_(MotionPreparer(source.camera(), config).frames_back()),
        running_(source.camera(), config) {}

  [[nodiscard]] int frames_back() const { return frames_back_; }
  [[nodiscard]] bool sees_every_frame() const { return method_of(config_).needs.keeps_state; }

  /// A frame after those it saw before, with sees_every_frame(); any frame otherwise.
  [[nodiscard]] JudgedFrame judge(int index) {
    const Frame frame = source_.read(index);
    Frame reference;
    JudgedFrame judged{"", std::to_string(index), fmt::format("{:06d}", index)};
    if (!sees_every_frame() && frames_back_ > 0) {
      reference = source_.read(index - frames_back_);
      judged.reference = std::to_string(index - frames_back_);
      if (!reference.readable()) judged.result.note = "no mask: " + reference.problem;
    }
    if (judged.result.note.empty()) judged.result.note = problem_of(frame);
    if (!judged.result.note.empty()) return judged;
    std::optional<MotionReplay> fresh;
    MotionReplay& replay = sees_every_frame() ? running_ : fresh.emplace(before(index, reference));
    judge_frame(frame, replay, judged);
    if (judged.log.reference >= 0) judged.reference = std::to_string(judged.log.reference);
    return judged;
  }

  /// Takes a frame into the state, with sees_every_frame().
  void see(int index) {
    const Frame frame = source_.read(index);
    if (problem_of(frame).empty()) (void)running_.repeat(frame, nullptr);
  }

 private:
  /// Why a frame cannot be judged; empty when all is well.
  [[nodiscard]] std::string problem_of(const Frame& frame) const {
    if (!frame.readable()) return "no mask: " + frame.problem;
    if (method_of(config_).needs.depth && !frame.has_depth())
      return fmt::format("no mask: {}", frame.problem.empty() ? "the frame has no depth" : frame.problem);
    return {};
  }

  /// The place before a frame, of a method without state. @param earliest the first frame it needs
  [[nodiscard]] MotionReplay before(int index, const Frame& earliest) const {
    const int first = index - frames_back_;
    // What lies farther back must not stand in for a frame between that cannot be read.
    const auto read = [&](int i) { return i < first ? Frame{} : i == first ? earliest : source_.read(i); };
    // What is not prepared is taken in frame by frame.
    const int start = frames_prepared_back_ < frames_back_ ? first : index;
    MotionReplay replay(source_.camera(), config_, MotionStage(source_.camera(), config_), start, index,
                        read);
    for (int i = start; i < index; ++i) (void)replay.repeat(read(i), nullptr);
    return replay;
  }

  const FrameSource& source_;
  const Config& config_;
  int frames_back_, frames_prepared_back_;
  MotionReplay running_;
};

void run_sequence(const MotionOptions& options, const Config& config, const MethodInfo& method) {
  // Its warnings are about cameras and times, which images alone do without.
  OpenOptions open;
  open.seed = static_cast<unsigned>(config.run.seed);
  open.progress = opening_progress();
  const std::unique_ptr<FrameSource> source = open_sequence(options.first, open);
  if (method.needs.depth && !source->has_depth())
    throw InputError(
        fmt::format("{}: has colour frames only, and --method {} needs depth", options.first, method.name));
  SequenceJudge judge(*source, config);
  const bool every = judge.sees_every_frame();
  const int gap = every ? 0 : judge.frames_back();
  std::vector<int> frames =
      parse_frame_ranges(options.frames.empty() ? "0:" : options.frames, source->size());
  std::erase_if(frames, [gap](int frame) { return frame < gap; });
  if (frames.empty())
    throw InputError(fmt::format("{}: of its {} frames none of those chosen has a reference {} frames back",
                                 options.first, source->size(), gap));
  throw_if_among_data(options.out, {options.first});
  MotionOutput output(options.out, options.force, options.all_rounds, method, judge.frames_back());
  describe_stand_in(options, method);
  int seen = 0;  // frames that a method with state has been shown
  for (const int index : frames) {
    while (every && seen < index && !stop_requested()) judge.see(seen++);
    if (stop_requested()) break;
    const JudgedFrame frame = judge.judge(index);
    seen = index + 1;
    output.add(frame);
    print_frame(frame);
  }
  output.finish(config);
  std::printf("%d frames, %d of them without a mask; figures in %s\n", output.frames(), output.without_mask(),
              (fs::path(options.out) / "motion.csv").c_str());
  throw_if_interrupted(
      fmt::format("stopped after {}; what was done is kept", counted(output.frames(), "frame")));
}

}  // namespace

void add_motion_command(CLI::App& app) {
  auto options = std::make_shared<MotionOptions>();
  CLI::App* command =
      app.add_subcommand("motion",
                         "What is dynamic between two images, or along a folder of colour frames: "
                         "masks, the method's stages, figures");
  command
      ->add_option("FIRST", options->first, "The previous image; or a sequence, when no next image is given")
      ->required();
  command->add_option("NEXT", options->second, "The next image, of the same size");
  command->add_option("--out", options->out, "Folder for the results, made if missing")->required();
  options->config.add_to(*command, false);
  command->add_option(
      "--frames", options->frames,
      "Frames of a sequence to judge, otherwise all: 10, 20:40:5 (40 not among them), -1 is the last; with "
      "commas between; those too near its start to have a reference are left out");
  command->add_option("--method", options->method,
                      fmt::format("What judges: {}", fmt::join(described_methods(), "; ")));
  command->add_flag("--all-rounds", options->all_rounds, "Pictures of every round, not of the last alone");
  command->add_flag("--force", options->force, "Overwrite earlier results");
  command->callback([options] {
    Config config = options->config.config();
    const MethodInfo& method = judging_method(method_named_by(*options));
    config.run.method = method.name;
    if (options->second.empty())
      run_sequence(*options, config, method);
    else
      run_pair(*options, config, method);
  });
}

}  // namespace stillpoint
