#include <array>
#include <exception>
#include <string>

#include "commands.h"
#include "console.h"
#include "program.h"

namespace {

using namespace orbifit;
using commands::kCompare;

constexpr std::array kCommands{
    Command{"info", "Show the size, components and defects of a mesh.",
            "orbifit info chair.obj\n"
            "orbifit info chair.obj --json",
            commands::info},
    Command{"detect", "Find the symmetric regions of a mesh or a scan.",
            "orbifit detect chair.obj -o chair.json\n"
            "orbifit detect chair.obj -o chair.json --preview chair.png --colour chair_regions.ply\n"
            "orbifit detect noisy.ply -o noisy.json --tolerance 0.02 --time-budget 30\n"
            "orbifit detect --points scan.pcd -o scan.json",
            commands::detect},
    Command{
        "annotate",
        "Correct an annotation by hand: add a region (roughly its plane, axis or centre, and a face or a point of it), "
        "remove, rename or list regions.",
        "orbifit annotate cup.obj -o cup.json --plane 0 0 0 1 0 0 --seed-face 812\n"
        "orbifit annotate cup.obj -o cup.json --annotation cup.json --axis 0 0 0 0 0 1 --order inf --seed-face 12\n"
        "orbifit annotate wheel.stl -o wheel.json --axis 3 0 1 0 1 0 --group C5v --near 3 0.2 1 --name hub\n"
        "orbifit annotate cup.obj --annotation cup.json --list\n"
        "orbifit annotate cup.obj --annotation cup.json -o cup.json --remove 3,5 --rename 2 handle",
        commands::annotate},
    Command{"check", "Measure how symmetric the regions of a mesh are, at rest or after a deformation.",
            "orbifit check chair.obj chair.json\n"
            "orbifit check chair.obj chair.json --deformed edited.obj --max-residual 1e-9",
            commands::check},
    Command{"symmetrize", "Move a mesh to the nearest one whose symmetries are exact.",
            "orbifit symmetrize scanned.ply scanned.json -o symmetric.ply\n"
            "orbifit symmetrize chair.obj chair.json -o exact.obj --annotation-out exact.json\n"
            "orbifit symmetrize gear.obj gear.json -o new.obj --remesh --annotation-out new.json",
            commands::symmetrize},
    Command{"subspace", "Build the subspace of a mesh's symmetric deformations and describe it.",
            "orbifit subspace chair.obj chair.json\n"
            "orbifit subspace chair.obj chair.json --samples 300 --mode fixed -o chair.basis\n"
            "orbifit subspace chair.obj chair.json --lift paper --compare-lifts",
            commands::subspace},
    Command{"deform", "Edit a mesh with handles; its symmetries are kept.",
            "orbifit deform chair.obj chair.json --handles handles.json -o edited.obj\n"
            "orbifit deform chair.obj chair.json --handles handles.json -o edited.obj --annotation-out edited.json\n"
            "orbifit deform chair.obj chair.json --basis chair.basis --handles handles.json -o edited.obj",
            commands::deform},
    Command{"edit", "Make a page in which one drags handles and the symmetries are kept.",
            "orbifit edit chair.obj -o chair.html --open\n"
            "orbifit edit chair.obj chair.json -o chair.html\n"
            "orbifit edit chair.obj chair.json --mode moving -o chair.html",
            commands::edit},
    Command{"fit", "Fit a template to a scan; its symmetries are kept and complete what the scan does not show.",
            "orbifit fit chair.obj scan.ply -o fitted.obj\n"
            "orbifit fit chair.obj scan.ply --annotation chair.json -o fitted.obj --report fit.json --html fit.html\n"
            "orbifit fit chair.obj scan.ply --landmarks landmarks.json -o fitted.obj\n"
            "orbifit fit chair.obj front.ply back.ply -o fitted.obj\n"
            "orbifit fit chair.obj depth.png --intrinsics 525,525,319.5,239.5 --mask mask.png -o fitted.obj",
            commands::fit},
    kCompare,
    Command{"generate", "Generate a model whose symmetries are known.",
            "orbifit generate --list\n"
            "orbifit generate chair -o models\n"
            "orbifit generate chair --param slats=6 --param back_tilt=12 -o models",
            commands::generate},
    Command{"scan", "Scan a mesh with a virtual depth camera.",
            "orbifit scan chair.obj -o scan.ply\n"
            "orbifit scan chair.obj --views 3 --noise 0.002 --azimuth 40 --elevation 25 -o scan.ply",
            commands::scan},
    Command{"convert", "Convert a mesh or a scan to another format.",
            "orbifit convert chair.glb chair.obj\n"
            "orbifit convert scan.pcd scan.ply\n"
            "orbifit convert chair.ply chair_points.ply --points\n"
            "orbifit convert chair.json pairs.csv --mesh chair.obj --element 1\n"
            "orbifit convert chair.json models_info.json --mesh obj_000001.ply",
            commands::convert},
    Command{"render", "Draw a picture of a mesh, its regions, or a scan over it.",
            "orbifit render chair.obj -o chair.png\n"
            "orbifit render chair.obj --annotation chair.json -o regions.png\n"
            "orbifit render chair.obj --points scan.ply --up 0 1 0 -o fit.png",
            commands::render},
    Command{"batch", "Do a whole collection, each item in a process of its own; look at and export the results.",
            "orbifit batch models --task detect --out results\n"
            "orbifit batch manifest.jsonl --task fit --out results --jobs 8 --item-timeout 300 --item-memory 4G\n"
            "orbifit batch manifest.jsonl --task detect --out results --shard 3/64\n"
            "orbifit batch manifest.jsonl --task detect --out results --retry timeout,crash\n"
            "orbifit batch status results\n"
            "orbifit batch report results\n"
            "orbifit batch export results --sqlite orbifit.db --csv tables\n"
            "orbifit batch manifest shapenet ShapeNetCore.v2 -o manifest.jsonl",
            commands::batch},
    Command{"report", "Combine texts, tables and pictures into one self-contained HTML page.",
            "orbifit report steps.json -o index.html", commands::report},
};

}  // namespace

std::span<const Command> orbifit::commands::all() {
  return kCommands;
}

int main(int argc, char** argv) {
  try {
    return run_program(kCommands, argc, argv);
  } catch (const std::exception& error) {
    Console(false).error(std::string("internal error: ") + error.what());
    return kNoResult;
  }
}
