// read_mcap.mjs FILE: reads an MCAP file with the readers of other projects and prints what they read as JSON.
//
// Both readers of @mcap/core read it, by the index and from the start, with all checksums. Messages are decoded by the
// schemas in the file: Protocol Buffers by protobufjs, ROS 2 by @foxglove/rosmsg2-serialization. Schemas of Foxglove's
// messages are compared with those of @foxglove/schemas. Any difference ends the program with an error.
import assert from "node:assert";
import { open } from "node:fs/promises";
import { createRequire } from "node:module";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parse as parseRosDefinition } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
const require = createRequire(import.meta.url);
const protobuf = require("protobufjs");
require("protobufjs/ext/descriptor");
const foxglove = require("@foxglove/schemas/internal");

/** The fields of a type of protobufjs: name, number, type and whether it is repeated. */
function fieldsOf(type) {
  return Object.fromEntries(type.fieldsArray.map((field) => {
    field.resolve();
    const name = field.resolvedType?.fullName.replace(/^\./, "") ?? field.type;
    return [field.name, { number: field.id, type: name, repeated: field.repeated }];
  }));
}

/** Foxglove's own definition of all its messages, with Google's time. */
function foxgloveRoot() {
  const root = new protobuf.Root();
  const time = 'syntax = "proto3"; package google.protobuf; message Timestamp { int64 seconds = 1; int32 nanos = 2; } ' +
    'message Duration { int64 seconds = 1; int32 nanos = 2; }';
  protobuf.parse(time, root, { keepCase: true });
  for (const [name, schema] of Object.entries(foxglove.foxgloveMessageSchemas)) {
    const enums = Object.values(foxglove.foxgloveEnumSchemas).filter((e) => e.parentSchemaName === name);
    protobuf.parse(foxglove.generateProto(schema, enums), root, { keepCase: true });
  }
  return root.resolveAll();
}

/** Checks that each message of the file's schema is Foxglove's, perhaps with fewer fields. */
function checkAgainstFoxglove(root, foxglove_root, name) {
  const own = root.lookupType(name), theirs = foxglove_root.lookupType(name);
  const expected = fieldsOf(theirs);
  for (const [field, description] of Object.entries(fieldsOf(own)))
    assert.deepStrictEqual(description, expected[field], `${name}.${field}`);
  for (const field of own.fieldsArray) {
    if (field.resolvedType instanceof protobuf.Type) checkAgainstFoxglove(root, foxglove_root, field.resolvedType.fullName);
    if (field.resolvedType instanceof protobuf.Enum)
      assert.deepStrictEqual({ ...field.resolvedType.values },
        { ...foxglove_root.lookupEnum(field.resolvedType.fullName).values });
  }
}

function protobufDecoder(schema, foxglove_root) {
  const root = protobuf.Root.fromDescriptor(schema.data).resolveAll();
  checkAgainstFoxglove(root, foxglove_root, schema.name);
  const type = root.lookupType(schema.name);
  return (data) => type.toObject(type.decode(data), { longs: Number, enums: String, bytes: String });
}

function rosDecoder(schema) {
  const reader = new MessageReader(parseRosDefinition(new TextDecoder().decode(schema.data), { ros2: true }));
  return (data) => JSON.parse(JSON.stringify(reader.readMessage(data), (_, value) => {
    if (typeof value === "bigint") return Number(value);
    return ArrayBuffer.isView(value) ? Array.from(value) : value;
  }));
}

async function readByIndex(file, size) {
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const { buffer, bytesRead } = await file.read(new Uint8Array(Number(length)), 0, Number(length), Number(offset));
      assert.strictEqual(bytesRead, Number(length));
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const messages = [];
  for await (const message of reader.readMessages()) messages.push(message);
  return { reader, messages };
}

function readFromStart(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true, includeChunks: false });
  reader.append(bytes);
  const records = [];
  for (let record; (record = reader.nextRecord()); ) records.push(record);
  assert(reader.done(), "the end of the file is missing");
  return records;
}

const file = await open(process.argv[2]);
const { size } = await file.stat();
const { reader, messages } = await readByIndex(file, size);
const { buffer } = await file.read(new Uint8Array(size), 0, size, 0);
const records = readFromStart(buffer);
assert.strictEqual(records.filter((record) => record.type === "Message").length, messages.length);
assert.strictEqual(Number(reader.statistics.messageCount), messages.length);

const foxglove_root = foxgloveRoot();
const decoders = new Map();
for (const [id, schema] of reader.schemasById)
  decoders.set(id, schema.encoding === "protobuf" ? protobufDecoder(schema, foxglove_root) : rosDecoder(schema));
const decoded = messages.map((message) => {
  const channel = reader.channelsById.get(message.channelId);
  return {
    topic: channel.topic,
    encoding: channel.messageEncoding,
    schema: reader.schemasById.get(channel.schemaId).name,
    logTime: String(message.logTime),
    message: decoders.get(channel.schemaId)(message.data),
  };
});
console.log(JSON.stringify({ profile: reader.header.profile, messages: decoded }));
