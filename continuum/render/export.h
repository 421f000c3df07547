// `talus export`: render points as files that other programs import, one for each frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "continuum/render/colours.h"
#include "continuum/render/render_file.h"

namespace talus {

struct ExportOptions {
  std::filesystem::path run;
  std::optional<std::filesystem::path> output;  // else RUN/export
  std::string frames = "all";                   // as chosen_frames has it
  std::string format = "ply";                   // or "vtk"
  std::vector<std::string> colours;             // "MATERIAL=#RRGGBB"
};

/// Writes OUTPUT/frame_000000.ply and so on; or .vtp, with render.pvd, which tells ParaView their times. Throws InputError.
void export_points(const ExportOptions& options);

/// Binary PLY: x, y, z, nx, ny, nz (float), red, green, blue, material (uchar), identity (uint). `comment`: one line.
std::string ply_of(const RenderFrame& frame, const std::vector<Colour>& colours, const std::string& comment);

/// VTK's XML of points, with raw numbers appended: a vertex for each, with normal, colour, material, identity and speed.
std::string vtp_of(const RenderFrame& frame, const std::vector<Colour>& colours, const std::string& comment);

/// The collection that gives files their times, s.
std::string pvd_of(const std::vector<std::pair<double, std::string>>& files);

}  // namespace talus
