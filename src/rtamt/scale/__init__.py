"""Suites over many recordings and fleets over streams: in a process pool, and on the engines that users have.

A *job* checks one recording after another and never fails: what is wrong with a recording becomes the error of its
rows. Engines distribute recordings; a manifest remembers what is done. A *shard* is a fleet for a part of a stream: it
rejects single samples; a checkpoint remembers its state and its place in the stream.

====================  =====================================================================
module                purpose
====================  =====================================================================
recordings            the recordings that patterns and addresses name, each with its version
job                   what is done with one recording, on every engine
bags                  the same with a bag, of which each requirement reads its own topics
members               what a requirement over the members of groups reads of a recording
manifest              the results so far, in a file: nothing is computed twice
local                 the engine on this machine: a process pool
spark                 the engine on Apache Spark
spark_stream          fleets on streams of Spark, whose state is in RocksDB
ray                   the engine on Ray Data
engines               the list of engines, and all recordings of a job: new ones by an engine
shard                 a fleet that takes any samples, and rejects those that are wrong one by one
inputs                what a message has of each variable
arrivals              when keys had their last message, so that silent ones expire
messages              messages of a broker to samples: JSON, Avro, protobuf
avro                  messages in Avro, whose schemas are bounded
protobuf              messages in protobuf, by descriptors
checkpoints           state and offset of a shard, in one object of a folder or an object store
kafka_settings        where a worker reads and writes, and the settings of its clients
kafka                 the worker: a consumer group, one partition a shard
====================  =====================================================================

Needs nothing beyond the core for local files and the local engine; each other engine is an extra.
"""
