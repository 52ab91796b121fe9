// What the reader of the format's authors finds in a file: a line of JSON with each topic's count, schema and
// first and last stamp. Needs the npm packages @mcap/core and fzstd where node finds them.
const fs = require("fs");
const { McapIndexedReader } = require("@mcap/core");
const fzstd = require("fzstd");

async function main(path) {
  const file = await fs.promises.open(path);
  const size = BigInt((await file.stat()).size);
  const readable = {
    size: async () => size,
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, Number(length), Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({
    readable,
    decompressHandlers: { zstd: (bytes, length) => fzstd.decompress(bytes, new Uint8Array(Number(length))) },
  });
  const topics = {};
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    const topic = (topics[channel.topic] ??= { count: 0, schema: schema.name, first: Number(message.logTime) });
    topic.count += 1;
    topic.last = Number(message.logTime);
  }
  console.log(JSON.stringify(topics));
}

main(process.argv[2]).catch((error) => {
  console.error(String(error));
  process.exit(1);
});
