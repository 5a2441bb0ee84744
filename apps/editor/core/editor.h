#pragma once

// The editor's core as the page calls it, compiled to WebAssembly: plain functions on a session, numbers and text.
// A call that fails returns a negative number, or null, and editor_error() says why; the session is then as it was.
// Arrays that are returned belong to the session and stay valid until the next call that changes it. Lengths are in
// mesh units; what is shown is in the display's frame: (x - centre) / diagonal.

#include <cstdint>

#ifdef __cplusplus
extern "C" {
#endif

struct EditorSession;

struct EditorSession* editor_new(void);
void editor_free(struct EditorSession* session);
const char* editor_error(void);
uint8_t* editor_allocate(int bytes); /* for what the page hands over; freed with editor_release() */
void editor_release(void* memory);

/* Files of the virtual file system. */
int editor_read_mesh(struct EditorSession* session, const char* file);
/* consistent: 1 where editor_annotation() gave it, in this session or another; it is then taken as it is. */
int editor_read_annotation(struct EditorSession* session, const char* file, int consistent);
int editor_read_basis(struct EditorSession* session, const char* file);
int editor_write_basis(struct EditorSession* session, const char* file);
int editor_write_mesh(struct EditorSession* session, const char* file, int at_rest);
/* mode: 0 fixed, 1 floating, 2 moving; lift: 0 orbit, 1 paper; radius, mesh units, and samples: 0 chooses;
   sharp: 1 places samples on sharp edges first; radius_field: a file, as `orbifit deform` takes it, or null. */
int editor_build_basis(struct EditorSession* session, int mode, int lift, double radius, int samples, int sharp,
                       const char* radius_field);
/* The annotation as it is kept, as JSON. */
const char* editor_annotation(struct EditorSession* session);
/* Counts, sizes and the basis as JSON. */
const char* editor_info(struct EditorSession* session);

/* What is shown. side: 0 symmetric, 1 without symmetries. */
int editor_display_vertices(struct EditorSession* session);
int editor_display_triangles(struct EditorSession* session);
const uint32_t* editor_triangles(struct EditorSession* session);        /* 3 a triangle */
const float* editor_positions(struct EditorSession* session, int side); /* 3 a shown vertex */
const float* editor_normals(struct EditorSession* session, int side);
const uint8_t* editor_marks(struct EditorSession* session); /* 4 a shown vertex: orbit, region, handle, pin */
const double* editor_vertices(struct EditorSession* session, int side); /* 3 a vertex of the mesh, mesh units */

/* handles.json; \return their number */
int editor_set_handles(struct EditorSession* session, const char* file);
/* Centroid of a handle's vertices at rest, 3 numbers, and how many vertices there are. */
int editor_handle_centroid(struct EditorSession* session, int handle, double* centroid);
/* motions: 12 numbers a handle, 3 by 4, by row. onwards: 1 starts from what was solved for last, 0 from rest, so that
   nothing depends on what was before. record: solve, lift and show in ms, handle error, energy. */
int editor_solve(struct EditorSession* session, int side, const double* motions, int count, int iterations, int onwards,
                 double* record);
int editor_rest(struct EditorSession* session);
int editor_show(struct EditorSession* session, const double* vertices);
/* basis: a file with one of an empty annotation, which the side without symmetries has; null: no such side. */
int editor_compare(struct EditorSession* session, const char* basis);
/* 2 numbers a region: rms and max, fractions of the diagonal. kind: 0 of the deformation, 1 of the one without
   symmetries, 2 of the shape shown. \return the number of regions */
int editor_residuals(struct EditorSession* session, int kind, double* numbers);
/* 12 numbers: what carries the region's group. */
int editor_carried(struct EditorSession* session, int region, double* motion);

/* A ray in the display's frame. point: 3 of the point in that frame, 3 barycentric weights. \return face, -1: none */
int editor_pick(struct EditorSession* session, const double* ray, double* point);
/* The orbit of a point of the surface; marks what lies within the radius. \return the number of its points, whose shown
   places editor_orbit_points() has, 3 numbers each */
int editor_orbit(struct EditorSession* session, int face, const double* barycentric, double radius);
const float* editor_orbit_points(struct EditorSession* session);
/* Where the point is at rest, 3 numbers, mesh units. */
int editor_rest_point(struct EditorSession* session, int face, const double* barycentric, double* point);
/* Numbers of the regions that hold a face. \return how many */
int editor_regions_of(struct EditorSession* session, int face, int32_t* regions, int most);
int editor_mark_region(struct EditorSession* session, int region); /* -1: none */
int editor_clear_orbit(struct EditorSession* session);

/* A report as JSON. */
const char* editor_symmetrize(struct EditorSession* session);
const double* editor_symmetric(struct EditorSession* session); /* 3 a vertex */
int editor_set_symmetric(struct EditorSession* session, const double* vertices);
int editor_blend(struct EditorSession* session, double share);
int editor_keep_blend(struct EditorSession* session, double share);

/* Reads a scan; \return its number of points, whose shown places editor_scan_points() has */
int editor_read_scan(struct EditorSession* session, const char* file);
const float* editor_scan_points(struct EditorSession* session);
/* Called at each step of a fit: its number, rms distance and stiffness; positions and normals are then the step's. */
typedef void (*EditorFitStep)(int number, double rms, double stiffness);
/* What the fit found, as JSON. */
const char* editor_fit(struct EditorSession* session, const char* scan, int place, EditorFitStep step);

#ifdef __cplusplus
}
#endif
