// Poses of the strands' roots, carried by their bones. Requires step_input.glsl and strand_offsets.glsl.
struct RootPoses {
  Pose begin, end;  // at the start and the end of the step
};

Pose carriedRoot(Pose rest, Pose bone) { return Pose(apply(bone, rest.position), multiply(bone.rotation, rest.rotation)); }
RootPoses rootPoses(uint strand) {
  const uint bones = settings.bone_count, bone = offsets[2u * settings.strand_count + 1u + strand];
  const Pose rest = poseAt(2u * bones + strand);
  return RootPoses(carriedRoot(rest, poseAt(bone)), carriedRoot(rest, poseAt(bone + bones)));
}
