//! Content of a file as seen by readers: from its end through the index, and from its start record
//! by record.

use std::collections::BTreeMap;

use iiwa_log::{JointSample, Recording};
use mcap::sans_io::indexed_reader::{IndexedReadEvent, IndexedReader};

/// Returns the log times by topic that the index leads to; checks them against the summary.
pub(crate) fn by_index(file: &[u8]) -> BTreeMap<String, Vec<u64>> {
    let summary = mcap::Summary::read(file).unwrap().unwrap();
    let mut times: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    let mut reader = IndexedReader::new(&summary).unwrap();
    while let Some(event) = reader.next_event() {
        match event.unwrap() {
            IndexedReadEvent::ReadChunkRequest { offset, length } => {
                let start = usize::try_from(offset).unwrap();
                reader.insert_chunk_record_data(offset, &file[start..][..length]).unwrap();
            }
            IndexedReadEvent::Message { header, .. } => {
                let topic = &summary.channels[&header.channel_id].topic;
                times.entry(topic.clone()).or_default().push(header.log_time);
            }
        }
    }

    let statistics = summary.stats.as_ref().unwrap();
    let counts: BTreeMap<_, _> = statistics
        .channel_message_counts
        .iter()
        .map(|(id, count)| (summary.channels[id].topic.clone(), *count))
        .collect();
    assert_eq!(counts, times.iter().map(|(topic, t)| (topic.clone(), t.len() as u64)).collect());
    assert_eq!(statistics.message_count, counts.values().sum::<u64>());
    assert_eq!(statistics.chunk_count as usize, summary.chunk_indexes.len());
    assert_eq!(Some(statistics.message_start_time), times.values().flatten().min().copied());
    assert_eq!(Some(statistics.message_end_time), times.values().flatten().max().copied());

    let mut indexed: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    for chunk in &summary.chunk_indexes {
        for (channel, entries) in summary.read_message_indexes(file, chunk).unwrap() {
            let topic = indexed.entry(channel.topic.clone()).or_default();
            topic.extend(entries.iter().map(|entry| entry.log_time));
        }
    }
    assert_eq!(indexed, times);
    times
}

/// Returns the joint states, read from the start, and their number according to the index.
pub(crate) fn both_ways(file: &[u8]) -> (Vec<JointSample>, usize) {
    let recording = Recording::from_bytes(file).unwrap();
    assert!(recording.robot_description.is_some());
    let indexed = by_index(file).remove("/joint_states").unwrap_or_default();
    (recording.joint_states, indexed.len())
}

/// Returns the joint states; checks that both ways of reading agree.
pub(crate) fn joint_states(file: &[u8]) -> Vec<JointSample> {
    let (states, indexed) = both_ways(file);
    assert_eq!(states.len(), indexed);
    states
}
