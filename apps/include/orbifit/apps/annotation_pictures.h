#pragma once

#include <functional>
#include <string>
#include <vector>

#include "orbifit/apps/render.h"

namespace orbifit {

struct AnnotationPicture {
  Image image;
  std::string title;   ///< which region or pattern, its group or kind, its name
  std::string detail;  ///< how large it is and how exact
};

/// A picture of every region, then of every pattern. Where the rest hides one it is seen through the rest, which is
/// glass then; a small one is drawn once more, enlarged, in a corner. Without regions and patterns: the mesh alone.
/// \param view      its frame is set to the mesh where it is empty
/// \param decorate  may add to each scene, such as a scan's points
std::vector<AnnotationPicture> annotation_pictures(const Mesh& mesh, const SymmetryAnnotation& annotation,
                                                   ViewOptions view, const RunContext& context,
                                                   const std::function<void(Scene&)>& decorate = nullptr);

/// All of them on one sheet, each with its title and detail below.
/// \param columns  at most so many side by side
Image contact_sheet(const std::vector<AnnotationPicture>& pictures, int columns);

}  // namespace orbifit
