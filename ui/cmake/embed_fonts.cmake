# Finds the fonts of the interface among Debian's packages and writes an assembler file that lays their bytes into
# the program. Sets embedded_fonts_source.

function(stillpoint_find_font variable package)
  find_file(${variable} NAMES ${ARGN} PATHS
    /usr/share/fonts/opentype/inter /usr/share/fonts/truetype/inter
    /usr/share/fonts/truetype/jetbrains-mono /usr/share/fonts/opentype/jetbrains-mono
    /usr/share/fonts/truetype/font-awesome /usr/share/fonts-font-awesome/fonts
    NO_DEFAULT_PATH NO_CACHE)
  if(NOT ${variable})
    list(GET ARGN 0 wanted)
    message(FATAL_ERROR "The font ${wanted} is missing; install the package ${package}.")
  endif()
  set(${variable} "${${variable}}" PARENT_SCOPE)
endfunction()

stillpoint_find_font(font_regular fonts-inter Inter-Regular.otf Inter-Regular.ttf)
stillpoint_find_font(font_semibold fonts-inter Inter-SemiBold.otf Inter-SemiBold.ttf)
stillpoint_find_font(font_mono fonts-jetbrains-mono JetBrainsMono-Regular.ttf JetBrainsMono-Regular.otf)
stillpoint_find_font(font_icons fonts-font-awesome fontawesome-webfont.ttf)

set(assembler ".section .rodata\n")
foreach(face IN ITEMS regular semibold mono icons)
  string(APPEND assembler "
.global stillpoint_font_${face}, stillpoint_font_${face}_end
.balign 16
stillpoint_font_${face}:
.incbin \"${font_${face}}\"
stillpoint_font_${face}_end:
.byte 0
")
endforeach()
string(APPEND assembler "\n.section .note.GNU-stack,\"\",%progbits\n")
set(embedded_fonts_source "${CMAKE_CURRENT_BINARY_DIR}/embedded_fonts.S")
file(CONFIGURE OUTPUT "${embedded_fonts_source}" CONTENT "${assembler}" @ONLY)
