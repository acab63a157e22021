// Where a strand's root is at the start and at the end of a step. Needs step_input.glsl and strand_offsets.glsl.

struct RootPoses {
  Pose begin, end;
};

Pose carried(Pose by, Pose local) {
  return Pose(carried(by, local.position), multiply(by.rotation, local.rotation));
}
RootPoses rootPoses(uint strand) {
  Pose rest = poseAt(2u * settings.bone_count + strand);
  uint bone = offsets[2u * settings.strand_count + 1u + strand];
  return RootPoses(carried(poseAt(bone), rest), carried(poseAt(bone + settings.bone_count), rest));
}
