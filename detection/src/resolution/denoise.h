#pragma once

#include "orbifit/model/run_context.h"

#include "surface/surface_patch.h"

namespace orbifit {

/// Standard deviation of independent noise in the vertices along their normals, in the mesh's diagonals: half of the
/// vertices are off the mean of their neighbours by no more than their neighbours are, but for this. 0 for meshes too
/// coarse to tell (fewer than 1500 vertices, or edges longer than a fiftieth of the diagonal on average), and where the
/// offsets do not look independent: what the edges of many small parts make is no noise.
double noise_of(const PreparedMesh& prepared);

/// Takes noise out of the vertices and leaves creases sharp: face normals are averaged with those of neighbours that
/// are near and look alike (bilateral normal filtering, Zheng, Fu, Au, Tai 2011), then vertices move to where the faces
/// at them have those normals (Sun, Rosin, Martin, Langbein 2007). Faces and their order stay.
/// \param sigma of the noise, as noise_of() says
void denoise(PreparedMesh& prepared, double sigma, const RunContext& context);

}  // namespace orbifit
