#include "render/loading/scene_file_model.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <stdexcept>

#include "frame/float_traps.h"
#include "render/loading/scene_file_json.h"
#include "render/loading/scene_file_textures.h"

namespace eigenlight {
namespace {

/// Degrees. Where a model has no normals, sharper edges stay sharp: boxes keep their edges, and
/// scans become smooth. Chosen by eye.
constexpr float kSmoothingAngle = 40.0f;

glm::vec3 to_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::mat4 to_mat4(const aiMatrix4x4& m) {
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
          m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

/// Reads the triangles with finite corners; drops all other triangles, lines and points.
void read_triangles(const aiMesh& from, Mesh& mesh, std::vector<std::string>& notes) {
  std::size_t broken = 0;
  for (unsigned i = 0; i < from.mNumFaces; ++i) {
    const aiFace& face = from.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const glm::uvec3 t(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
    const bool usable = std::max({t.x, t.y, t.z}) < from.mNumVertices &&
                        finite(mesh.positions[t.x]) && finite(mesh.positions[t.y]) &&
                        finite(mesh.positions[t.z]);
    if (usable) {
      mesh.triangles.push_back(t);
    } else {
      ++broken;
    }
  }
  if (broken > 0) {
    notes.push_back(fmt::format(
        "mesh \"{}\": dropped {} triangles with NaN, Inf or missing vertices", mesh.name, broken));
  }
}

glm::vec3 area_normal(const Mesh& mesh, const glm::uvec3& t) {
  const glm::vec3& a = mesh.positions[t.x];
  return cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
}

/// Replaces vertex normals that are zero or NaN by the normal of a triangle that uses the vertex.
void mend_normals(Mesh& mesh) {
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 flat = area_normal(mesh, t);
    const float length = glm::length(flat);
    for (int k = 0; k < 3; ++k) {
      glm::vec3& normal = mesh.normals[t[k]];
      if (!(dot(normal, normal) > 0.0f) && length > 0.0f) normal = flat / length;
    }
  }
}

Mesh read_mesh(const aiMesh& from, unsigned uv_channel, std::vector<std::string>& notes) {
  Mesh mesh;
  mesh.name = from.mName.C_Str();
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    mesh.positions.push_back(to_vec3(from.mVertices[i]));
  }
  read_triangles(from, mesh, notes);
  if (from.HasNormals()) {
    for (unsigned i = 0; i < from.mNumVertices; ++i) {
      const glm::vec3 normal = to_vec3(from.mNormals[i]);
      mesh.normals.push_back(finite(normal) ? normal : glm::vec3(0.0f));
    }
    mend_normals(mesh);
  }
  if (from.HasTextureCoords(uv_channel)) {
    for (unsigned i = 0; i < from.mNumVertices; ++i) {
      // assimp puts v = 0 at the bottom for every format; Texture has it at the top.
      const glm::vec2 uv(from.mTextureCoords[uv_channel][i].x,
                         1.0f - from.mTextureCoords[uv_channel][i].y);
      mesh.texcoords.push_back(std::isfinite(uv.x) && std::isfinite(uv.y) ? uv : glm::vec2(0.0f));
    }
  }
  return mesh;
}

/// Whether any triangle is more than a single point. Other triangles without area do no harm,
/// because no ray meets them.
bool has_extent(const Mesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const glm::uvec3& t) {
    const glm::vec3& a = mesh.positions[t.x];
    return mesh.positions[t.y] != a || mesh.positions[t.z] != a;
  });
}

/// Adds one instance for each mesh of each node. `mesh_index` maps the meshes of assimp to those of
/// the scene; dropped meshes have -1.
void read_nodes(const aiNode& node, const aiMatrix4x4& parent, const std::vector<int>& mesh_index,
                Scene& scene) {
  const aiMatrix4x4 to_world = parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const int mesh = mesh_index[node.mMeshes[i]];
    if (mesh >= 0) scene.instances.push_back({mesh, to_mat4(to_world)});
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    read_nodes(*node.mChildren[i], to_world, mesh_index, scene);
  }
}

/// Returns null if assimp cannot read the file.
const aiScene* read_file(const std::filesystem::path& path, Assimp::Importer& importer) {
  const FloatTrapsOff models_may_hold_nan;
  importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kSmoothingAngle);
  return importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_GenSmoothNormals);
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

void load_model(const std::filesystem::path& path, Scene& scene, std::vector<std::string>& notes) {
  if (!std::filesystem::is_regular_file(path)) {
    throw std::runtime_error(fmt::format("{}: no such model file", path.string()));
  }
  Assimp::Importer importer;
  const aiScene* model = read_file(path, importer);
  if (model == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot read model: {}", short_name(path),
                                         first_line(importer.GetErrorString())));
  }
  const int first_material = static_cast<int>(scene.materials.size());
  const std::vector<unsigned> uv_channels = read_materials({*model, path}, scene, notes);

  std::vector<int> mesh_index(model->mNumMeshes, -1);
  for (unsigned i = 0; i < model->mNumMeshes; ++i) {
    const unsigned material = model->mMeshes[i]->mMaterialIndex;
    Mesh mesh = read_mesh(*model->mMeshes[i], uv_channels[material], notes);
    if (!has_extent(mesh)) {
      notes.push_back(
          fmt::format("mesh \"{}\": dropped, because all its triangles are points", mesh.name));
      continue;
    }
    mesh.material = first_material + static_cast<int>(material);
    mesh_index[i] = static_cast<int>(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
  }
  if (model->mRootNode != nullptr) {
    read_nodes(*model->mRootNode, aiMatrix4x4(), mesh_index, scene);
  }
  if (scene.instances.empty()) {
    throw std::runtime_error(
        fmt::format("{}: no triangles, expected a model with surfaces", short_name(path)));
  }
}

}  // namespace eigenlight
