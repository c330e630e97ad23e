// The columns are the axes that a unit quaternion turns x, y and z to. `part`: its parts but the largest one, which is
// positive; `largest`: the number of that, 0 of the real part.
mat3 axes_of_quaternion(vec3 part, uint largest) {
  float rest = sqrt(max(1.0 - dot(part, part), 0.0));
  float w = largest == 0u ? rest : part.x;
  vec3 v = part;
  if (largest == 1u) v = vec3(rest, part.y, part.z);
  if (largest == 2u) v = vec3(part.y, rest, part.z);
  if (largest == 3u) v = vec3(part.y, part.z, rest);
  return mat3(1.0 - 2.0 * (v.y * v.y + v.z * v.z), 2.0 * (v.x * v.y + w * v.z), 2.0 * (v.x * v.z - w * v.y),
              2.0 * (v.x * v.y - w * v.z), 1.0 - 2.0 * (v.x * v.x + v.z * v.z), 2.0 * (v.y * v.z + w * v.x),
              2.0 * (v.x * v.z + w * v.y), 2.0 * (v.y * v.z - w * v.x), 1.0 - 2.0 * (v.x * v.x + v.y * v.y));
}
