#pragma once

#include <imgui.h>

/// Icons of Font Awesome 4.7 by what we use them for: UTF-8, to be put into any text of Fonts::text, strong
/// or heading.
namespace stillpoint::icons {

inline constexpr ImWchar kFirst = 0xF002, kLast = 0xF279;

inline constexpr const char* kSearch = "\xef\x80\x82";
inline constexpr const char* kStar = "\xef\x80\x85";
inline constexpr const char* kFilm = "\xef\x80\x88";
inline constexpr const char* kLayout = "\xef\x80\x89";
inline constexpr const char* kCheck = "\xef\x80\x8c";
inline constexpr const char* kClose = "\xef\x80\x8d";
inline constexpr const char* kSettings = "\xef\x80\x93";
inline constexpr const char* kClock = "\xef\x80\x97";
inline constexpr const char* kDownload = "\xef\x80\x99";
inline constexpr const char* kRefresh = "\xef\x80\xa1";
inline constexpr const char* kLock = "\xef\x80\xa3";
inline constexpr const char* kFlag = "\xef\x80\xa4";
inline constexpr const char* kBookmark = "\xef\x80\xae";
inline constexpr const char* kCamera = "\xef\x80\xb0";
inline constexpr const char* kList = "\xef\x80\xba";
inline constexpr const char* kImage = "\xef\x80\xbe";
inline constexpr const char* kContrast = "\xef\x81\x82";
inline constexpr const char* kStepBack = "\xef\x81\x88";
inline constexpr const char* kFastBack = "\xef\x81\x8a";
inline constexpr const char* kPlay = "\xef\x81\x8b";
inline constexpr const char* kPause = "\xef\x81\x8c";
inline constexpr const char* kStop = "\xef\x81\x8d";
inline constexpr const char* kFastForward = "\xef\x81\x8e";
inline constexpr const char* kStepForward = "\xef\x81\x91";
inline constexpr const char* kChevronLeft = "\xef\x81\x93";
inline constexpr const char* kChevronRight = "\xef\x81\x94";
inline constexpr const char* kQuestion = "\xef\x81\x99";
inline constexpr const char* kInfo = "\xef\x81\x9a";
inline constexpr const char* kCrosshairs = "\xef\x81\x9b";
inline constexpr const char* kMaximise = "\xef\x81\xa5";
inline constexpr const char* kRestore = "\xef\x81\xa6";
inline constexpr const char* kPlus = "\xef\x81\xa7";
inline constexpr const char* kMinus = "\xef\x81\xa8";
inline constexpr const char* kShow = "\xef\x81\xae";
inline constexpr const char* kHide = "\xef\x81\xb0";
inline constexpr const char* kWarning = "\xef\x81\xb1";
inline constexpr const char* kRandom = "\xef\x81\xb4";
inline constexpr const char* kChevronUp = "\xef\x81\xb7";
inline constexpr const char* kChevronDown = "\xef\x81\xb8";
inline constexpr const char* kFolderOpen = "\xef\x81\xbc";
inline constexpr const char* kLink = "\xef\x83\x81";
inline constexpr const char* kSave = "\xef\x83\x87";
inline constexpr const char* kBars = "\xef\x83\x89";
inline constexpr const char* kTable = "\xef\x83\x8e";
inline constexpr const char* kUndo = "\xef\x83\xa2";
inline constexpr const char* kBolt = "\xef\x83\xa7";
inline constexpr const char* kSwap = "\xef\x83\xac";
inline constexpr const char* kKeyboard = "\xef\x84\x9c";
inline constexpr const char* kBug = "\xef\x86\x88";
inline constexpr const char* kTarget = "\xef\x86\x92";
inline constexpr const char* kCube = "\xef\x86\xb2";
inline constexpr const char* kHistory = "\xef\x87\x9a";
inline constexpr const char* kSliders = "\xef\x87\x9e";
inline constexpr const char* kChart = "\xef\x88\x81";
inline constexpr const char* kLayers = "\xef\x89\x8d";
inline constexpr const char* kMap = "\xef\x89\xb9";

}  // namespace stillpoint::icons
