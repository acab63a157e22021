-- Shakes the head of a groom from Lua, over LCM: `poser.lua [GROOM [DOMAIN [SECONDS]]]`. On Debian it needs the
-- packages lua5.2, liblcm-lua and liblcm-bin, and nothing of Strandcast but the schema:
--
--   lcm-gen -l --lpath build/lua transport/lcm/strandcast.lcm
--   strandcastd --transport lcm --scene straight &    # in another terminal; its default is DDS
--   LUA_PATH="build/lua/?.lua;;" lua5.2 examples/poser-lua/poser.lua
--
-- It says which daemon it moves, or that none is heard. docs/wire.md, "PoseSamples", has the fields.

unpack = unpack or table.unpack -- lcm-gen writes for Lua 5.1
local lcm = require('lcm')
local pose_samples_t = require('strandcast_v7.pose_samples_t')

local groom, domain, seconds = tonumber(arg[1] or 1), tonumber(arg[2] or 0), tonumber(arg[3] or math.huge)
local kRate = 60 -- samples a second
local kSamples = 3 -- in each message, because LCM repeats nothing
local kPivot = {0, 0, 0} -- m, where head and neck meet in the groom's frame

local link = lcm.lcm.new('udpm://239.255.76.67:' .. 7667 + domain .. '?ttl=0')

--- Seconds by a clock that runs evenly; Lua has none.
local function now()
  local file = assert(io.open('/proc/uptime'))
  local time = file:read('*n')
  file:close()
  return time
end

--- Motion of the head at a time: x_world = rotation * x_rest + position, about the pivot.
local function poseAt(time)
  local angle = 0.5 * math.sin(2 * math.pi * time) * math.min(1, time)
  local c, s = math.cos(angle), math.sin(angle)
  local x, y, z = unpack(kPivot)
  local turned = {c * x + s * z, y, c * z - s * x} -- about Y
  return {x - turned[1], y - turned[2], z - turned[3], 0, math.sin(angle / 2), 0, math.cos(angle / 2)}
end

-- A daemon sends its groom each second. What is in it does not matter here.
local is_heard = false
link:subscribe('STRANDCAST_GROOM_' .. groom, function()
  if not is_heard then print(('moving the head of groom %d'):format(groom)) end
  is_heard = true
end)

math.randomseed(os.time())
local message = pose_samples_t:new()
message.source = math.random(1, 2 ^ 31 - 1)
message.groom_id = groom
message.names_revision = 1
link:timedhandle(0) -- LCM tests its sockets at the first call, which takes up to a second
local start = now()
local offset = math.floor(start) * 1e9 -- ns; whole, so that doubles hold the times exactly
for number = 1, seconds * kRate do
  while (now() - start) * kRate < number do link:timedhandle(0.002) end
  if number == 3 * kRate and not is_heard then
    print(('no daemon of groom %d is heard: strandcastd --transport lcm --domain %d'):format(groom, domain))
  end
  message.newest = number
  message.names = (number - 1) % (kRate / 2) == 0 and 'head' or '' -- twice a second
  message.ages, message.poses = {}, {}
  local period = math.floor(1e9 / kRate)
  message.time = offset + number * period
  for back = 0, math.min(kSamples, number) - 1 do
    table.insert(message.ages, back * period)
    -- The time that a sample shows, not that of the call, whose jitter the hair would show
    for _, value in ipairs(poseAt((number - back) / kRate)) do table.insert(message.poses, value) end
  end
  message.ages_length, message.poses_length = #message.ages, #message.poses
  link:publish('STRANDCAST_POSE_' .. groom, message:encode())
end
