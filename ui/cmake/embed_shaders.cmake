# Writes OUTPUT, a C++ source that holds the text of every file in SHADERS (a list, `,` between names).
string(REPLACE "," ";" files "${SHADERS}")
set(entries "")
foreach(file IN LISTS files)
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" text)
  string(APPEND entries "    {\"${name}\", R\"glsl(${text})glsl\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "// Generated from shaders/.
#include \"ui/gl/embedded_shaders.hpp\"

#include <map>

namespace stillpoint {

std::string_view embedded_shader(std::string_view file_name) {
  static const std::map<std::string_view, std::string_view> kShaders = {
${entries}  };
  return kShaders.at(file_name);
}

}  // namespace stillpoint
")
