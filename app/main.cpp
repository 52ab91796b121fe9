#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <string>
#include <string_view>

#include "app/commands.hpp"
#include "app/progress.hpp"
#include "app/version.hpp"
#include "core/allocator.hpp"
#include "core/error.hpp"

namespace {

/// What was printed may have gone nowhere: into a pipe nobody reads, or onto a full disk.
bool output_arrived() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  std::fprintf(stderr, "stillpoint: standard output cannot be written (%s)\n",
               std::strerror(errno != 0 ? errno : EIO));
  return false;
}

/// `--out "$FOLDER"` with a variable that is not set would be as good as none.
void throw_if_empty_value(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i], before = argv[i - 1];
    const bool is_value = i > 1 && before.starts_with("--") && before.find('=') == before.npos;
    if (word.empty() && is_value) throw CLI::ValidationError(std::string(before), "its value is empty");
    if (word.starts_with("--") && word.find('=') == word.size() - 1)
      throw CLI::ValidationError(std::string(word.substr(0, word.size() - 1)), "its value is empty");
  }
}

}  // namespace

int main(int argc, char** argv) {
  stillpoint::tune_allocator();

  // Stages run beside each other here; threads inside OpenCV as well would only contend for the same cores.
  cv::setNumThreads(1);
  // What is wrong with an image is said once, by whoever reads it.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  CLI::App app{
      "Stillpoint: a visual debugger for RGB-D and stereo visual odometry in scenes where things move",
      "stillpoint"};
  app.require_subcommand(0, 1);
  app.set_version_flag("--version", stillpoint::version_text());
  stillpoint::add_commands(app);
  try {
    throw_if_empty_value(argc, argv);
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) stillpoint::view_demo();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? (output_arrived() ? 0 : 1) : 2;
  } catch (const stillpoint::Interrupted& interrupted) {
    (void)output_arrived();
    std::fprintf(stderr, "stillpoint: %s\n", interrupted.told.c_str());
    return 128 + interrupted.signal;
  } catch (const stillpoint::ExitStatus& exit) {
    return output_arrived() ? exit.status : 1;
  } catch (const stillpoint::InputError& error) {
    std::fprintf(stderr, "stillpoint: %s\n", error.what());
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stillpoint: unexpected: %s\n", error.what());
    return 1;
  }
  return output_arrived() ? 0 : 1;
}
