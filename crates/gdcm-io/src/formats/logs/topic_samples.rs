//! A log's topics while it is read; each topic has its own time stamps.

use std::sync::Arc;

use gdcm_sysid::records::RecordColumn;
use gdcm_sysid::records::record_table::TopicClock;

use crate::reading_budget::{ReadingBudget, VariableFault};

/// Minimum number of samples in a topic; shorter topics, such as single status messages, are
/// ignored.
const FEWEST_SAMPLES: usize = 3;

/// Topic with the samples read so far.
pub(super) struct TopicSamples {
    pub(super) name: String,
    pub(super) fields: Vec<TopicField>,
    pub(super) time_s: Vec<f64>,
}

/// Topic field with the samples read so far.
pub(super) struct TopicField {
    pub(super) name: String,
    pub(super) unit: Option<String>,
    pub(super) values: Vec<f64>,
}

impl TopicSamples {
    /// Creates a topic with these fields and no samples.
    pub(super) fn new(name: String, fields: Vec<TopicField>) -> Self {
        Self {
            name,
            fields,
            time_s: Vec::new(),
        }
    }

    pub(super) fn field(&self, name: &str) -> Option<&TopicField> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Appends a sample: the time stamp and a value for each field, in field order.
    pub(super) fn push(
        &mut self,
        time_s: f64,
        values: impl IntoIterator<Item = f64>,
        budget: &ReadingBudget<'_>,
    ) -> Result<(), VariableFault> {
        budget.take(self.fields.len() as u64 + 1, 8, &self.name)?;
        self.time_s.push(time_s);
        for (field, value) in self.fields.iter_mut().zip(values) {
            field.values.push(value);
        }
        Ok(())
    }

    /// Converts the fields to columns, which share a time axis; returns none if there are fewer
    /// than `FEWEST_SAMPLES` samples.
    pub(super) fn into_columns(self) -> Vec<RecordColumn> {
        if self.time_s.len() < FEWEST_SAMPLES {
            return Vec::new();
        }
        let clock = Arc::new(TopicClock {
            name: self.name,
            time_s: self.time_s,
        });
        let mut columns = Vec::with_capacity(self.fields.len());
        for field in self.fields {
            let name = format!("{}.{}", clock.name, field.name);
            columns.push(RecordColumn {
                unit: field.unit,
                topic: Some(Arc::clone(&clock)),
                ..RecordColumn::new(name, field.values)
            });
        }
        columns
    }
}
