//! Limits on the number of connections, in total and per address.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex};

use mariana_work::lock;

use crate::limits::Limits;

/// The open connections per address. Clones share the contents.
#[derive(Clone, Default)]
pub(crate) struct ConnectionLimit(Arc<Mutex<HashMap<IpAddr, usize>>>);

/// A counted connection. Dropping it frees the slot.
pub(crate) struct ConnectionSlot {
    connection_limit: ConnectionLimit,
    address: IpAddr,
}

impl ConnectionLimit {
    pub(crate) fn reserve(&self, address: IpAddr, limits: &Limits) -> Option<ConnectionSlot> {
        let address = address.to_canonical();
        let mut taken = lock(&self.0);
        let of_address = taken.get(&address).copied().unwrap_or_default();
        let is_free = of_address < limits.connections_per_address_max
            && taken.values().sum::<usize>() < limits.connections_max;
        is_free.then(|| {
            taken.insert(address, of_address + 1);
            ConnectionSlot { connection_limit: self.clone(), address }
        })
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        let mut taken = lock(&self.connection_limit.0);
        match taken.get_mut(&self.address) {
            Some(count) if *count > 1 => *count -= 1,
            _ => drop(taken.remove(&self.address)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::LIMITS;

    #[test]
    fn one_address_cannot_take_all_slots() {
        let connection_limit = ConnectionLimit::default();
        let take = |last: u8| connection_limit.reserve(IpAddr::from([10, 0, 0, last]), &LIMITS);
        let mut taken: Vec<ConnectionSlot> =
            (0..LIMITS.connections_per_address_max).map_while(|_| take(1)).collect();
        assert_eq!(taken.len(), LIMITS.connections_per_address_max);
        assert!(take(1).is_none());
        taken.extend((0..=LIMITS.connections_max).map_while(|number| take(2 + number as u8)));
        assert_eq!(taken.len(), LIMITS.connections_max, "the total number is limited");
        taken.clear();
        assert!(take(1).is_some());
        assert!(connection_limit.0.lock().unwrap().is_empty(), "closed connections leave no entries");
    }
}
